// A window's Vulkan surface.
#pragma once

#include "gpu/device.hpp"
#include "gpu/handle.hpp"
#include "viewer/window/window.hpp"

namespace palpa::viewer {

/// The surface must be destroyed after everything that presents to it and before the device's instance.
class WindowSurface {
 public:
  WindowSurface(const gpu::Device& device, const Window& window)
      : instance_(device.instance()), surface_(window.make_surface(instance_)) {}
  ~WindowSurface() {
    if (!gpu::device_abandoned) vkDestroySurfaceKHR(instance_, surface_, nullptr);
  }
  WindowSurface(const WindowSurface&) = delete;
  WindowSurface& operator=(const WindowSurface&) = delete;
  VkSurfaceKHR get() const { return surface_; }

 private:
  VkInstance instance_;
  VkSurfaceKHR surface_;
};

}  // namespace palpa::viewer
