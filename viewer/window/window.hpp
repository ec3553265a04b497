// A window, its events and its Vulkan surface. window.cpp is the only file that knows GLFW.
#pragma once

#include <volk.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "viewer/hands/controls.hpp"

namespace palpa::viewer {

class Window {
 public:
  /// Throws Error (Exit::no_device), suggesting --headless, where there is no display or none that Vulkan can present
  /// to.
  Window(std::uint32_t width, std::uint32_t height, const char* title);
  /// All of a monitor, an index into monitors(); the last where there are not so many. Beside another window.
  Window(std::size_t monitor, const char* title);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  /// Instance extensions for gpu::DeviceOptions.
  std::vector<const char*> extensions() const;
  /// The caller destroys it, before the instance and after everything that presents to it.
  VkSurfaceKHR make_surface(VkInstance instance) const;

  /// In pixels; 0 x 0 while minimised.
  VkExtent2D size() const;
  /// Pixels per point: 2 on a high-resolution screen.
  double pixel_ratio() const;
  /// Waits for something to happen, at most `timeout_s` (0: only looks; negative: for ever), and appends what did, with
  /// positions in pixels.
  void wait(double timeout_s, std::vector<WindowEvent>& events);
  /// From any thread: ends a wait().
  static void wake();
  void resize(std::uint32_t width, std::uint32_t height);
  /// What other programs put there, and for them.
  std::string clipboard() const;
  void set_clipboard(const std::string& text);
  /// The user asked to close it.
  bool closing() const;
  /// What happened to this window while another waited.
  void take(std::vector<WindowEvent>& events);

  /// What there is to fill, "NAME WxH" in pixels; while there is a window.
  static std::vector<std::string> monitors();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace palpa::viewer
