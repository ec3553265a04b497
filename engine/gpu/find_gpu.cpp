#include "gpu/find_gpu.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <vector>

#include "gpu/device.hpp"

namespace palpa::gpu {
namespace {

/// Any driver of a GPU opens one of these: the kernel's render nodes, or the devices of NVIDIA, WSL, Mali and Adreno.
bool has_graphics_device() {
  std::error_code error;
  if (!std::filesystem::is_empty("/dev/dri", error) && !error) return true;
  constexpr std::array others{"/dev/nvidiactl", "/dev/nvgpu", "/dev/dxg", "/dev/mali0", "/dev/kgsl-3d0"};
  return std::ranges::any_of(others, [&](const char* path) { return std::filesystem::exists(path, error); });
}

}  // namespace

std::optional<std::string> find_gpu() {
  if (!has_graphics_device()) return std::nullopt;
  const std::vector<DeviceDescription> devices = list_devices();
  const DeviceDescription* best = best_of(devices);
  return best && best->kind != "cpu" ? std::optional(best->name) : std::nullopt;
}

}  // namespace palpa::gpu
