// A window, its events and its Vulkan surface. Only window.cpp and fixed_keys.hpp know GLFW.
#pragma once

#include <volk.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "viewer/hands/controls.hpp"
#include "viewer/options/preferences.hpp"

namespace palpa::viewer {

/// How large a window is at first, and where.
struct WindowWish {
  std::uint32_t width = 0, height = 0;
  bool in_points = false;  ///< and no larger than the monitor; else in pixels
  /// Where a window was before; it replaces the size. If that is off all monitors, only its size counts.
  std::optional<WindowPlace> before{};
  const char* instead = "use --headless --screenshot FILE.png";  ///< advice if there is no display
};

class Window {
 public:
  /// Throws Error (Exit::no_device) with the wish's advice if there is no display, or none that Vulkan can present to.
  Window(const WindowWish& wish, const char* title);
  /// Fills a monitor. `monitor` is an index into monitors(); if there are fewer, it is the last. In addition to another
  /// window. Without `pointer`, the mouse pointer is hidden in it.
  Window(std::size_t monitor, const char* title, bool pointer = false);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  /// Instance extensions for gpu::DeviceOptions.
  std::vector<const char*> extensions() const;
  /// The caller destroys it, before the instance and after everything that presents to it.
  VkSurfaceKHR make_surface(VkInstance instance) const;

  /// In pixels; 0 x 0 while minimised.
  VkExtent2D size() const;
  /// Pixels per point: 2 on a high-resolution screen. The monitor's scale, or $GDK_SCALE if that is larger.
  double pixel_ratio() const;
  /// Waits for events, at most `timeout_s` (0: only looks; negative: for ever), and appends them, with positions in
  /// pixels.
  void wait(double timeout_s, std::vector<WindowEvent>& events);
  /// Ends a wait(). May be called from any thread.
  static void wake();
  void resize(std::uint32_t width, std::uint32_t height);
  /// Gives it that place and size, in the units of place(), if the display lets programs do that.
  void move(const WindowPlace& place);
  /// The part of the first monitor that windows may use, in the same units; nullopt if it is not known.
  std::optional<WindowPlace> work_area() const;
  void set_title(const std::string& title);
  /// Where it is; nullopt while it is minimised, maximised or hidden.
  std::optional<WindowPlace> place() const;
  /// Text from other programs, and for them.
  std::string clipboard() const;
  void set_clipboard(const std::string& text);
  /// Whether the user asked to close the window.
  bool closing() const;
  /// Takes the events of this window that came while another window waited.
  void take(std::vector<WindowEvent>& events);

  /// The monitors, "NAME WxH" in pixels. Only while there is a window.
  static std::vector<std::string> monitors();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace palpa::viewer
