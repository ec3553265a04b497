// The Vulkan instance, the device and its only queue. Independent of windows and of hands.
#pragma once

#include <volk.h>

#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <vector>

#include "base/words.hpp"

namespace palpa::gpu {

/// Validation presets. Each includes the one before, except gpu_assisted, which the layer cannot combine with sync.
enum class Validation {
  off,
  core,          ///< the layer's ordinary checks
  sync,          ///< core + synchronization, also across command buffers of one submit
  gpu_assisted,  ///< core + shader instrumentation: out-of-bounds accesses
};

inline constexpr Word<Validation> validation_words[] = {{"off", Validation::off},
                                                        {"core", Validation::core},
                                                        {"sync", Validation::sync},
                                                        {"gpu-assisted", Validation::gpu_assisted}};

struct DeviceOptions {
  /// Part of a device's name (any case) or its index as listed by `palpa doctor`; empty: the fastest kind present.
  std::string select;
  /// Defaults to the environment's PALPA_VALIDATION, else off.
  std::optional<Validation> validation;
  /// Copy through staging buffers even if memory is unified, as on a discrete GPU. Defaults to PALPA_FORCE_STAGING=1.
  std::optional<bool> force_staging;
  /// Instance extensions that a window needs (from GLFW). If there are any, the device must also offer
  /// VK_KHR_swapchain.
  std::vector<const char*> window_extensions;
  /// Compute pipelines stay until the device ends, and passes that are made later share them. For programs that make
  /// many sessions on one device: making a pipeline again takes milliseconds.
  bool keep_pipelines = false;
};

/// What distinguishes compute pipelines: the kernel, the bytes of its push constants, its specialization constants.
using PipelineKey = std::tuple<const void*, std::uint32_t, std::vector<std::uint32_t>>;

struct DeviceDescription {
  std::uint32_t index = 0;
  std::string name;
  std::string driver;  ///< driver name and version
  std::string kind;    ///< "discrete", "integrated", "virtual", "cpu" or "other"
  /// The driver ends every loop of a kernel after 65,535 iterations. Set for Mesa's software device before version 25:
  /// version 22 was seen to end loops and 25 was not; 23 and 24 have not been tried.
  bool ends_long_loops = false;
  /// The driver crashes on a null pointer when it compiles any fragment shader (vkcube crashes, too), so nothing may be
  /// drawn with it. Set for Mesa 22's software device with vectors of 512 bits.
  bool cannot_draw = false;
  std::string unusable;  ///< why palpa cannot use it; empty if it can
};

/// All physical devices in index order. Empty if there is no Vulkan loader or driver. Throws Error (Exit::no_device) if
/// memory does not suffice to load the drivers; after that, no device can be used any more (gpu/handle.hpp).
std::vector<DeviceDescription> list_devices();
/// The device that is used if none is named: of the usable ones, the first of the fastest kind. Null if there is none.
const DeviceDescription* best_of(std::span<const DeviceDescription> devices);
bool validation_layer_present();

/// Number of validation errors reported in this process so far. Tests and programs fail if it is not zero.
std::uint64_t validation_errors();

class Device {
 public:
  /// Throws Error (Exit::no_device) with the reason for each unsuitable device.
  explicit Device(const DeviceOptions& options = {});
  ~Device();
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  VkInstance instance() const { return instance_; }
  VkPhysicalDevice physical() const { return physical_; }
  VkDevice get() const { return device_; }
  VkQueue queue() const { return queue_; }
  std::uint32_t queue_family() const { return queue_family_; }
  const DeviceDescription& description() const { return description_; }
  const VkPhysicalDeviceLimits& limits() const { return limits_; }
  Validation validation() const { return validation_; }
  /// Threads that the driver started for this device. Includes threads that other code started at the same time.
  const std::vector<int>& driver_threads() const { return driver_threads_; }
  /// The valid bits of a timestamp; the others are undefined.
  std::uint64_t timestamp_mask() const { return timestamp_mask_; }

  /// True if host and device share memory and staging was not requested. Uploads and readbacks then copy nothing.
  bool unified_memory() const { return unified_; }
  /// Index of a memory type with all of `required` and, if there is one, all of `preferred`; throws if there is none.
  std::uint32_t memory_type(std::uint32_t allowed_bits, VkMemoryPropertyFlags required,
                            VkMemoryPropertyFlags preferred) const;

  /// Guards the queue: vkQueueSubmit and vkQueuePresent need external synchronization.
  std::mutex& queue_mutex() const { return queue_mutex_; }

  bool keeps_pipelines() const { return keeps_pipelines_; }
  /// The kept object of that key, made by `make` if there is none yet. For ComputePipeline only. Any thread.
  std::shared_ptr<const void> kept_pipeline(const PipelineKey& key,
                                            const std::function<std::shared_ptr<const void>()>& make) const;

  void name(VkObjectType type, std::uint64_t object, const char* name) const;

  /// Counters that prove a loop's steady state: they do not change after its first frame.
  mutable std::atomic<std::uint64_t> memory_allocations{0};
  mutable std::atomic<std::uint64_t> pipelines_created{0};

  /// After this call, every submit reports VK_ERROR_DEVICE_LOST. Lets tests and rehearsals simulate a lost GPU.
  void lose() const { lost_ = true; }
  bool lost() const { return lost_; }

 private:
  void create_instance(const DeviceOptions& options);
  void choose_physical(const DeviceOptions& options);
  void create_device(bool window);
  void destroy();

  VkInstance instance_ = VK_NULL_HANDLE;
  VkDebugUtilsMessengerEXT messenger_ = VK_NULL_HANDLE;
  VkPhysicalDevice physical_ = VK_NULL_HANDLE;
  VkDevice device_ = VK_NULL_HANDLE;
  VkQueue queue_ = VK_NULL_HANDLE;
  std::uint32_t queue_family_ = 0;
  DeviceDescription description_;
  std::vector<int> driver_threads_;
  VkPhysicalDeviceLimits limits_{};
  VkPhysicalDeviceMemoryProperties memory_{};
  Validation validation_ = Validation::off;
  bool unified_ = false;
  bool names_ = false;
  std::uint64_t timestamp_mask_ = ~std::uint64_t{0};
  mutable std::mutex queue_mutex_;
  mutable std::atomic<bool> lost_{false};
  bool keeps_pipelines_ = false;
  mutable std::mutex kept_mutex_;
  mutable std::map<PipelineKey, std::shared_ptr<const void>> kept_;
};

}  // namespace palpa::gpu
