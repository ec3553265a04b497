#include "setup/options/compute.hpp"

#include <fmt/core.h>

#include <cstdlib>
#include <map>
#include <mutex>
#include <utility>

#include "base/error.hpp"
#include "gpu/find_gpu.hpp"

namespace palpa::setup {

namespace {

bool keeps_devices = false;

}  // namespace

UsedBackend choose_backend(const ComputeOptions& options, std::string_view environment,
                           const std::function<std::optional<std::string>()>& find_gpu) {
  const auto gpu = [](const std::string& name) { return UsedBackend{Backend::gpu, "there is a GPU, " + name}; };
  if (options.backend != Backend::automatic)
    return {options.backend, fmt::format("the backend {} was asked for", word_of(backend_words, options.backend))};
  if (!options.gpu.empty()) return {Backend::gpu, "a GPU was named"};
  if (options.validation.value_or(gpu::Validation::off) != gpu::Validation::off)
    return {Backend::gpu, "validation was asked for"};
  if (!environment.empty()) {
    const std::optional<Backend> named = value_of(backend_words, environment);
    if (!named) throw bad_usage(fmt::format("PALPA_BACKEND is '{}': give {}", environment, one_of(backend_words)));
    if (*named != Backend::automatic) return {*named, fmt::format("PALPA_BACKEND is {}", environment)};
  }
  if (options.device) return gpu(options.device->description().name);
  if (const std::optional<std::string> name = find_gpu()) return gpu(*name);
  return {Backend::cpu, "there is no GPU"};
}

UsedBackend used_backend(const ComputeOptions& options) {
  static const std::string environment = [] {
    const char* value = std::getenv("PALPA_BACKEND");
    return std::string(value ? value : "");
  }();
  return choose_backend(options, environment, [] {
    static const std::optional<std::string> name = gpu::find_gpu();
    return name;
  });
}

bool on_gpu(const ComputeOptions& options) {
  return used_backend(options).backend == Backend::gpu;
}

gpu::DeviceOptions device_options(const ComputeOptions& options) {
  gpu::DeviceOptions device;
  device.select = options.gpu;
  device.validation = options.validation;
  return device;
}

const gpu::Device* kept_device(const ComputeOptions& options) {
  if (!on_gpu(options)) return nullptr;
  static auto* const mutex = new std::mutex();
  static auto* const devices =
      new std::map<std::pair<std::string, std::optional<gpu::Validation>>, std::unique_ptr<gpu::Device>>();
  const std::lock_guard lock(*mutex);
  std::unique_ptr<gpu::Device>& device = (*devices)[{options.gpu, options.validation}];
  if (device && device->lost()) static_cast<void>(device.release());  // others may still wait for it
  if (!device) {
    gpu::DeviceOptions kept = device_options(options);
    kept.keep_pipelines = true;
    device = std::make_unique<gpu::Device>(kept);
  }
  return device.get();
}

void keep_devices() {
  keeps_devices = true;
}

UsedDevice::UsedDevice(const ComputeOptions& options) {
  if (!on_gpu(options)) return;
  if (options.device || keeps_devices) {
    device_ = options.device ? options.device : kept_device(options);
    return;
  }
  own_ = std::make_unique<gpu::Device>(device_options(options));
  device_ = own_.get();
}

}  // namespace palpa::setup
