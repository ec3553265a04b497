// What computes: a GPU or the processor, and which GPU.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

#include "base/words.hpp"
#include "gpu/device.hpp"

namespace palpa::setup {

enum class Backend {
  automatic,  ///< a GPU if there is one, otherwise the processor
  gpu,        ///< also a driver that does a GPU's work on the processor
  cpu,
};
inline constexpr Word<Backend> backend_words[] = {
    {"auto", Backend::automatic}, {"gpu", Backend::gpu}, {"cpu", Backend::cpu}};

/// What computes, and the seed.
struct ComputeOptions {
  std::string gpu;  ///< part of a device's name or its index; empty: the fastest kind present
  Backend backend = Backend::automatic;
  std::uint64_t seed = 0;
  std::optional<gpu::Validation> validation;
  /// An open device, which then computes instead of one that is opened for this computation alone; not with the backend
  /// cpu.
  const gpu::Device* device = nullptr;
};

/// A backend that is not automatic, and why it is used, as the rest of a sentence: "there is no GPU".
struct UsedBackend {
  Backend backend = Backend::gpu;
  std::string why;
};
/// The rule. What decides first: a backend that is not automatic; a GPU or a validation that is asked for;
/// `environment`, which is the value of $PALPA_BACKEND or empty; an open device; gpu::find_gpu(), which is called only
/// if nothing else decides. Throws bad_usage if the environment names no backend.
UsedBackend choose_backend(const ComputeOptions& options, std::string_view environment,
                           const std::function<std::optional<std::string>()>& find_gpu);
/// The same for this process, which looks for a GPU and at its environment once. Any thread. Throws also as
/// gpu::find_gpu().
UsedBackend used_backend(const ComputeOptions& options);
bool on_gpu(const ComputeOptions& options);

gpu::DeviceOptions device_options(const ComputeOptions& options);
/// A device that stays open until the program ends and keeps its pipelines: the same one for the same choice, or
/// another one if it was lost. Null on the processor. Any thread.
const gpu::Device* kept_device(const ComputeOptions& options);
/// From now on, every UsedDevice is a kept one: for a program that runs many commands.
void keep_devices();
/// The device of a computation: that of the options, or one that is opened and lives as long as this object. None on
/// the processor.
class UsedDevice {
 public:
  UsedDevice() = default;  ///< none
  explicit UsedDevice(const ComputeOptions& options);
  const gpu::Device* get() const { return device_; }

 private:
  std::unique_ptr<gpu::Device> own_;
  const gpu::Device* device_ = nullptr;
};

}  // namespace palpa::setup
