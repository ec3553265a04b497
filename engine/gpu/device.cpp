#include "gpu/device.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cstdlib>
#include <cstring>
#include <iterator>
#include <mutex>
#include <new>
#include <span>
#include <string_view>

#include "base/error.hpp"
#include "base/log.hpp"
#include "gpu/check.hpp"
#include "gpu/handle.hpp"
#include "gpu/patience.hpp"
#include "gpu/software.hpp"

namespace palpa::gpu {
namespace {

/// Vulkan's loader looks up an object's device in its list of all instances without a lock (1.4.309 has none). Naming
/// an object on one thread while another thread created or destroyed an instance or a device caused a crash.
std::mutex loader_mutex;

constexpr const char* validation_layer = "VK_LAYER_KHRONOS_validation";
std::atomic<std::uint64_t> validation_error_count{0};

VKAPI_ATTR VkBool32 VKAPI_CALL on_message(VkDebugUtilsMessageSeverityFlagBitsEXT severity,
                                          VkDebugUtilsMessageTypeFlagsEXT,
                                          const VkDebugUtilsMessengerCallbackDataEXT* data, void*) {
  if (severity & VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT) {
    ++validation_error_count;
    log::error(fmt::format("Vulkan validation: {}", data->pMessage));
  } else {
    log::debug(fmt::format("Vulkan validation: {}", data->pMessage));
  }
  return VK_FALSE;
}

/// A driver that runs out of memory while it is loaded throws through Vulkan's loader, which then holds a lock for
/// ever. Any code that needs the lock again would wait for ever, and so would the end of the program.
[[noreturn]] void out_of_memory() {
  device_abandoned = true;
  throw Error(Exit::no_device, "no Vulkan device: out of memory: " + driver_advice("close other programs"));
}

bool load_vulkan() try {
  static const bool loaded = volkInitialize() == VK_SUCCESS;
  return loaded;
} catch (const std::bad_alloc&) {
  out_of_memory();
}

std::vector<VkPhysicalDevice> physical_devices(VkInstance instance) {
  const std::lock_guard lock(loader_mutex);  // the loader leaves drivers without a device here
  std::uint32_t count = 0;
  if (vkEnumeratePhysicalDevices(instance, &count, nullptr) != VK_SUCCESS) return {};
  std::vector<VkPhysicalDevice> devices(count);
  if (vkEnumeratePhysicalDevices(instance, &count, devices.data()) < VK_SUCCESS) return {};
  devices.resize(count);
  return devices;
}

bool lists(std::span<const VkExtensionProperties> extensions, const char* name) {
  return std::any_of(extensions.begin(), extensions.end(),
                     [&](const auto& e) { return std::strcmp(e.extensionName, name) == 0; });
}

bool lists(std::span<const char* const> names, const char* name) {
  return std::any_of(names.begin(), names.end(), [&](const char* one) { return std::strcmp(one, name) == 0; });
}

/// Those of the loader and its drivers. At each call, the loader loads all drivers and unloads them again, so there
/// is one call, with room for what loaders usually have.
std::vector<VkExtensionProperties> instance_extensions() {
  std::vector<VkExtensionProperties> extensions(64);
  for (;;) {
    auto count = static_cast<std::uint32_t>(extensions.size());
    const VkResult result = vkEnumerateInstanceExtensionProperties(nullptr, &count, extensions.data());
    if (result == VK_INCOMPLETE) {
      extensions.resize(2 * extensions.size());
      continue;
    }
    extensions.resize(result == VK_SUCCESS ? count : 0);
    return extensions;
  }
}

/// The extensions that every instance gets, in addition to the requested ones, if the loader knows them: see
/// load_functions.
std::vector<const char*> with_usual_extensions(std::vector<const char*> wanted) {
  const std::vector<VkExtensionProperties> known = instance_extensions();
  for (const char* name : {VK_KHR_SURFACE_EXTENSION_NAME, VK_EXT_DEBUG_UTILS_EXTENSION_NAME}) {
    if (!lists(wanted, name) && lists(known, name)) wanted.push_back(name);
  }
  return wanted;
}

/// Vulkan's functions belong to the process, not to a device. The first instance loads them, once, so that they never
/// change while another thread calls them. They are the loader's functions, which find the driver by their arguments,
/// so they work for devices of several drivers.
void load_functions(VkInstance first) {
  static std::once_flag once;
  std::call_once(once, [&] { volkLoadInstance(first); });
}

bool has_extension(VkPhysicalDevice physical, const char* name) {
  std::uint32_t count = 0;
  vkEnumerateDeviceExtensionProperties(physical, nullptr, &count, nullptr);
  std::vector<VkExtensionProperties> extensions(count);
  vkEnumerateDeviceExtensionProperties(physical, nullptr, &count, extensions.data());
  return lists(extensions, name);
}

struct QueueFamily {
  std::uint32_t index, timestamp_bits;
};

/// A queue family that computes and, if there is one, also draws.
std::optional<QueueFamily> find_queue_family(VkPhysicalDevice physical) {
  std::uint32_t count = 0;
  vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  vkGetPhysicalDeviceQueueFamilyProperties(physical, &count, families.data());
  std::optional<QueueFamily> computes;
  for (std::uint32_t i = 0; i < count; ++i) {
    const VkQueueFlags flags = families[i].queueFlags;
    const QueueFamily family{i, families[i].timestampValidBits};
    if (!(flags & VK_QUEUE_COMPUTE_BIT) || family.timestamp_bits == 0) continue;
    if (flags & VK_QUEUE_GRAPHICS_BIT) return family;
    if (!computes) computes = family;
  }
  return computes;
}

const char* kind_name(VkPhysicalDeviceType type) {
  switch (type) {
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
      return "discrete";
    case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
      return "integrated";
    case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
      return "virtual";
    case VK_PHYSICAL_DEVICE_TYPE_CPU:
      return "cpu";
    default:
      return "other";
  }
}

int rank(const DeviceDescription& device) {
  constexpr std::array<const char*, 4> order{"discrete", "integrated", "virtual", "cpu"};
  return static_cast<int>(std::find(order.begin(), order.end(), device.kind) - order.begin());
}

std::string why_unusable(VkPhysicalDevice physical, const VkPhysicalDeviceProperties& properties) {
  if (properties.apiVersion < VK_API_VERSION_1_3) {
    return fmt::format("offers Vulkan {}.{}, palpa needs 1.3", VK_API_VERSION_MAJOR(properties.apiVersion),
                       VK_API_VERSION_MINOR(properties.apiVersion));
  }
  constexpr std::uint32_t shared_bytes = 32768;  // Vulkan guarantees half of it; splitting clusters takes 24 KB
  if (properties.limits.maxComputeSharedMemorySize < shared_bytes) {
    return fmt::format("has {} bytes of shared memory, palpa needs {}", properties.limits.maxComputeSharedMemorySize,
                       shared_bytes);
  }
  if (!find_queue_family(physical)) return "has no compute queue with timestamps";
  if (!has_extension(physical, VK_KHR_PUSH_DESCRIPTOR_EXTENSION_NAME)) return "lacks VK_KHR_push_descriptor";
  return {};
}

/// 22 of "Mesa 22.3.6 (LLVM 15.0.6)"; 0 if it is not stated.
int mesa_version(std::string_view driver_info) {
  constexpr std::string_view before = "Mesa ";
  const std::size_t at = driver_info.find(before);
  int version = 0;
  if (at != std::string_view::npos)
    std::from_chars(driver_info.data() + at + before.size(), driver_info.data() + driver_info.size(), version);
  return version;
}

DeviceDescription describe(VkPhysicalDevice physical, std::uint32_t index) {
  VkPhysicalDeviceProperties basic;
  vkGetPhysicalDeviceProperties(physical, &basic);
  VkPhysicalDeviceDriverProperties driver{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES};
  VkPhysicalDeviceProperties2 properties{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, &driver};
  vkGetPhysicalDeviceProperties2(physical, &properties);
  DeviceDescription d;
  d.index = index;
  d.name = basic.deviceName;
  d.driver = fmt::format("{} {}", driver.driverName, driver.driverInfo);
  d.kind = kind_name(basic.deviceType);
  d.ends_long_loops = driver.driverID == VK_DRIVER_ID_MESA_LLVMPIPE && mesa_version(driver.driverInfo) < 25;
  d.cannot_draw = d.name.find("512 bits") != std::string::npos && mesa_version(driver.driverInfo) == 22;
  d.unusable = why_unusable(physical, basic);
  return d;
}

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

bool selected(const DeviceDescription& device, const std::string& select) {
  if (select.empty()) return true;
  if (std::all_of(select.begin(), select.end(), [](unsigned char c) { return std::isdigit(c); })) {
    return std::to_string(device.index) == select;
  }
  return lower(device.name).find(lower(select)) != std::string::npos;
}

bool env_flag(const char* name) {
  const char* value = std::getenv(name);
  return value && *value && std::strcmp(value, "0") != 0;
}

Validation validation_from_environment() {
  const char* value = std::getenv("PALPA_VALIDATION");
  if (!value || !*value) return Validation::off;
  if (const auto preset = value_of(validation_words, value)) return *preset;
  throw bad_usage(fmt::format("PALPA_VALIDATION is '{}': give {}", value, one_of(validation_words)));
}

}  // namespace

std::uint64_t validation_errors() {
  return validation_error_count;
}

const DeviceDescription* best_of(std::span<const DeviceDescription> devices) {
  const DeviceDescription* best = nullptr;
  for (const DeviceDescription& device : devices) {
    if (device.unusable.empty() && (!best || rank(device) < rank(*best))) best = &device;
  }
  return best;
}

bool validation_layer_present() {
  if (!load_vulkan()) return false;
  std::uint32_t count = 0;
  vkEnumerateInstanceLayerProperties(&count, nullptr);
  std::vector<VkLayerProperties> layers(count);
  vkEnumerateInstanceLayerProperties(&count, layers.data());
  return std::any_of(layers.begin(), layers.end(),
                     [](const auto& layer) { return std::strcmp(layer.layerName, validation_layer) == 0; });
}

std::vector<DeviceDescription> list_devices() try {
  if (!load_vulkan() || !drivers_fit()) return {};
  VkApplicationInfo app{VK_STRUCTURE_TYPE_APPLICATION_INFO};
  app.apiVersion = VK_API_VERSION_1_3;
  const std::vector<const char*> extensions = with_usual_extensions({});
  VkInstanceCreateInfo info{VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO};
  info.pApplicationInfo = &app;
  info.enabledExtensionCount = static_cast<std::uint32_t>(extensions.size());
  info.ppEnabledExtensionNames = extensions.data();
  VkInstance instance = VK_NULL_HANDLE;
  const auto create = [&] {
    const std::lock_guard lock(loader_mutex);
    return vkCreateInstance(&info, nullptr, &instance);
  };
  if (create() != VK_SUCCESS) return {};
  load_functions(instance);
  std::vector<DeviceDescription> devices;
  for (VkPhysicalDevice physical : physical_devices(instance)) {
    devices.push_back(describe(physical, static_cast<std::uint32_t>(devices.size())));
  }
  const std::lock_guard lock(loader_mutex);
  vkDestroyInstance(instance, nullptr);
  return devices;
} catch (const std::bad_alloc&) {
  out_of_memory();
}

Device::Device(const DeviceOptions& options) {
  if (!load_vulkan()) {
    throw Error(Exit::no_device, "no Vulkan loader found: " +
                                     driver_advice("install libvulkan1 and a driver such as mesa-vulkan-drivers"));
  }
  if (!drivers_fit()) throw Error(Exit::no_device, "no Vulkan driver can be loaded: " + driver_advice());
  keeps_pipelines_ = options.keep_pipelines;
  validation_ = options.validation ? *options.validation : validation_from_environment();
  const std::vector<int> before = threads_of_process();
  try {
    create_instance(options);
    choose_physical(options);
    create_device(!options.window_extensions.empty());
    const std::vector<int> after = threads_of_process();
    std::set_difference(after.begin(), after.end(), before.begin(), before.end(), std::back_inserter(driver_threads_));
  } catch (const std::bad_alloc&) {
    out_of_memory();
  } catch (...) {
    destroy();
    throw;
  }
  unified_ = (description_.kind == "cpu" || description_.kind == "integrated") &&
             !options.force_staging.value_or(env_flag("PALPA_FORCE_STAGING"));
}

Device::~Device() {
  destroy();
}

std::shared_ptr<const void> Device::kept_pipeline(const PipelineKey& key,
                                                  const std::function<std::shared_ptr<const void>()>& make) const {
  const std::lock_guard lock(kept_mutex_);
  std::shared_ptr<const void>& kept = kept_[key];
  if (!kept) kept = make();
  return kept;
}

void Device::destroy() {
  kept_.clear();
  if (device_abandoned) return;
  const std::lock_guard lock(loader_mutex);
  if (device_) vkDestroyDevice(device_, nullptr);
  if (messenger_) vkDestroyDebugUtilsMessengerEXT(instance_, messenger_, nullptr);
  if (instance_) vkDestroyInstance(instance_, nullptr);
  device_ = VK_NULL_HANDLE;
  messenger_ = VK_NULL_HANDLE;
  instance_ = VK_NULL_HANDLE;
}

void Device::create_instance(const DeviceOptions& options) {
  VkApplicationInfo app{VK_STRUCTURE_TYPE_APPLICATION_INFO};
  app.pApplicationName = "palpa";
  app.apiVersion = VK_API_VERSION_1_3;

  std::vector<const char*> extensions = with_usual_extensions(options.window_extensions);
  std::vector<const char*> layers;
  std::vector<VkValidationFeatureEnableEXT> enables;
  if (validation_ != Validation::off) {
    if (!validation_layer_present()) {
      throw Error(Exit::no_device,
                  "validation was asked for, but VK_LAYER_KHRONOS_validation is not installed: "
                  "install vulkan-validationlayers");
    }
    layers.push_back(validation_layer);
    extensions.push_back(VK_EXT_VALIDATION_FEATURES_EXTENSION_NAME);
  }
  if (validation_ == Validation::sync) {
    enables = {VK_VALIDATION_FEATURE_ENABLE_SYNCHRONIZATION_VALIDATION_EXT};
    // The layer enables the check across command buffers only by this name, not by an enumerator.
    setenv("VK_LAYER_ENABLES", "VALIDATION_CHECK_ENABLE_SYNCHRONIZATION_VALIDATION_QUEUE_SUBMIT", 0);
  } else if (validation_ == Validation::gpu_assisted) {
    enables = {VK_VALIDATION_FEATURE_ENABLE_GPU_ASSISTED_EXT,
               VK_VALIDATION_FEATURE_ENABLE_GPU_ASSISTED_RESERVE_BINDING_SLOT_EXT};
  }
  names_ = lists(extensions, VK_EXT_DEBUG_UTILS_EXTENSION_NAME);  // they also help frame capture tools
  VkValidationFeaturesEXT features{VK_STRUCTURE_TYPE_VALIDATION_FEATURES_EXT};
  features.enabledValidationFeatureCount = static_cast<std::uint32_t>(enables.size());
  features.pEnabledValidationFeatures = enables.data();

  VkInstanceCreateInfo info{VK_STRUCTURE_TYPE_INSTANCE_CREATE_INFO};
  info.pNext = enables.empty() ? nullptr : &features;
  info.pApplicationInfo = &app;
  info.enabledLayerCount = static_cast<std::uint32_t>(layers.size());
  info.ppEnabledLayerNames = layers.data();
  info.enabledExtensionCount = static_cast<std::uint32_t>(extensions.size());
  info.ppEnabledExtensionNames = extensions.data();
  const auto create = [&] {
    const std::lock_guard lock(loader_mutex);
    return vkCreateInstance(&info, nullptr, &instance_);
  };
  const VkResult result = create();
  if (result != VK_SUCCESS) {
    throw Error(Exit::no_device, fmt::format("no Vulkan instance ({}): {}", result_name(result), driver_advice()));
  }
  load_functions(instance_);
  if (validation_ != Validation::off) {
    if (!names_) {
      throw Error(
          Exit::no_device,
          "validation was asked for, but the Vulkan loader has no VK_EXT_debug_utils: install a newer libvulkan1");
    }
    VkDebugUtilsMessengerCreateInfoEXT messenger{VK_STRUCTURE_TYPE_DEBUG_UTILS_MESSENGER_CREATE_INFO_EXT};
    messenger.messageSeverity =
        VK_DEBUG_UTILS_MESSAGE_SEVERITY_WARNING_BIT_EXT | VK_DEBUG_UTILS_MESSAGE_SEVERITY_ERROR_BIT_EXT;
    messenger.messageType = VK_DEBUG_UTILS_MESSAGE_TYPE_VALIDATION_BIT_EXT;
    messenger.pfnUserCallback = on_message;
    PALPA_VK(vkCreateDebugUtilsMessengerEXT(instance_, &messenger, nullptr, &messenger_));
  }
}

void Device::choose_physical(const DeviceOptions& options) {
  const auto devices = physical_devices(instance_);
  std::string reasons;
  std::vector<DeviceDescription> descriptions;
  for (std::uint32_t i = 0; i < devices.size(); ++i) {
    DeviceDescription d = describe(devices[i], i);
    if (d.unusable.empty() && !options.window_extensions.empty() &&
        !has_extension(devices[i], VK_KHR_SWAPCHAIN_EXTENSION_NAME)) {
      d.unusable = "cannot present to a window (no VK_KHR_swapchain)";
    }
    if (d.unusable.empty() && !selected(d, options.select)) {
      d.unusable = fmt::format("is not '{}'", options.select);
    }
    if (!d.unusable.empty()) {
      reasons += fmt::format("{}{} {} {}", reasons.empty() ? "" : "; ", i, d.name, d.unusable);
    }
    descriptions.push_back(std::move(d));
  }
  const DeviceDescription* best = best_of(descriptions);
  if (!best) {
    throw Error(Exit::no_device, devices.empty() ? "no Vulkan device: " + driver_advice()
                                                 : fmt::format("no usable Vulkan device: {}", reasons));
  }
  description_ = *best;
  physical_ = devices[best->index];
  VkPhysicalDeviceProperties properties;
  vkGetPhysicalDeviceProperties(physical_, &properties);
  limits_ = properties.limits;
  vkGetPhysicalDeviceMemoryProperties(physical_, &memory_);
}

void Device::create_device(bool window) {
  require_room_for(description_);
  const auto [family, bits] = find_queue_family(physical_).value();
  queue_family_ = family;
  timestamp_mask_ = bits >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << bits) - 1;
  const float priority = 1.0f;
  VkDeviceQueueCreateInfo queue{VK_STRUCTURE_TYPE_DEVICE_QUEUE_CREATE_INFO};
  queue.queueFamilyIndex = queue_family_;
  queue.queueCount = 1;
  queue.pQueuePriorities = &priority;

  VkPhysicalDeviceVulkan13Features v13{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_3_FEATURES};
  v13.synchronization2 = VK_TRUE;
  v13.dynamicRendering = VK_TRUE;
  v13.maintenance4 = VK_TRUE;
  VkPhysicalDeviceVulkan12Features v12{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_VULKAN_1_2_FEATURES, &v13};
  v12.timelineSemaphore = VK_TRUE;
  v12.hostQueryReset = VK_TRUE;
  VkPhysicalDeviceFeatures2 features{VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_FEATURES_2, &v12};

  std::vector<const char*> extensions{VK_KHR_PUSH_DESCRIPTOR_EXTENSION_NAME};
  if (window) extensions.push_back(VK_KHR_SWAPCHAIN_EXTENSION_NAME);
  VkDeviceCreateInfo info{VK_STRUCTURE_TYPE_DEVICE_CREATE_INFO, &features};
  info.queueCreateInfoCount = 1;
  info.pQueueCreateInfos = &queue;
  info.enabledExtensionCount = static_cast<std::uint32_t>(extensions.size());
  info.ppEnabledExtensionNames = extensions.data();
  const auto create = [&] {
    const std::lock_guard lock(loader_mutex);
    return vkCreateDevice(physical_, &info, nullptr, &device_);
  };
  if (const VkResult result = create(); result != VK_SUCCESS) {
    throw Error(Exit::no_device,
                fmt::format("{} cannot be used: vkCreateDevice returned {}", description_.name, result_name(result)));
  }
  vkGetDeviceQueue(device_, queue_family_, 0, &queue_);
}

std::uint32_t Device::memory_type(std::uint32_t allowed_bits, VkMemoryPropertyFlags required,
                                  VkMemoryPropertyFlags preferred) const {
  for (const VkMemoryPropertyFlags wanted : {required | preferred, required}) {
    for (std::uint32_t i = 0; i < memory_.memoryTypeCount; ++i) {
      if ((allowed_bits & (1u << i)) && (memory_.memoryTypes[i].propertyFlags & wanted) == wanted) return i;
    }
  }
  throw failure(fmt::format("{}: no memory type with flags {:#x}", description_.name, required));
}

void Device::name(VkObjectType type, std::uint64_t object, const char* name) const {
  if (!names_) return;
  VkDebugUtilsObjectNameInfoEXT info{VK_STRUCTURE_TYPE_DEBUG_UTILS_OBJECT_NAME_INFO_EXT};
  info.objectType = type;
  info.objectHandle = object;
  info.pObjectName = name;
  const std::lock_guard lock(loader_mutex);
  vkSetDebugUtilsObjectNameEXT(device_, &info);
}

}  // namespace palpa::gpu
