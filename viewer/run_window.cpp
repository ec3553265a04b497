#include <chrono>
#include <vector>

#include "viewer/run.hpp"
#include "viewer/swapchain.hpp"
#include "viewer/window.hpp"

namespace palpa::viewer {
namespace {

using Clock = std::chrono::steady_clock;
constexpr std::chrono::milliseconds slow_slot{250};

/// The surface goes after everything that presents to it and before the device's instance.
class WindowSurface {
 public:
  WindowSurface(const gpu::Device& device, const Window& window)
      : instance_(device.instance()), surface_(window.make_surface(instance_)) {}
  ~WindowSurface() { vkDestroySurfaceKHR(instance_, surface_, nullptr); }
  WindowSurface(const WindowSurface&) = delete;
  WindowSurface& operator=(const WindowSurface&) = delete;
  VkSurfaceKHR get() const { return surface_; }

 private:
  VkInstance instance_;
  VkSurfaceKHR surface_;
};

Size pixels_of(const Window& window) {
  const VkExtent2D extent = window.size();
  return {extent.width, extent.height};
}

}  // namespace

void run_window(const ViewerOptions& options) {
  const Size size = picture_size(options);
  Window window(size.width, size.height, "palpa");  // first: without a display nothing else is worth doing
  Show show(options);
  gpu::DeviceOptions device_options = setup::device_options(options.common);
  device_options.window_extensions = window.extensions();
  const gpu::Device device(device_options);
  const WindowSurface surface(device, window);
  Presenter presenter(device, surface.get());
  DrawnPicture drawn(device);
  const ViewState state = first_state(options);
  drawn.update(show.picture(), state);

  Size extent = pixels_of(window);
  Viewpoint viewpoint = first_viewpoint(options, show.picture(), state, extent);
  const Box home = home_of(options, show.picture(), state);
  Controls controls;
  std::vector<WindowEvent> events;
  std::uint64_t slot = options.slot;
  std::uint32_t frames_drawn = 0;
  bool dirty = true, playing = show.changes();
  Clock::time_point next_slot = Clock::now() + slow_slot;

  // Draws only when something has changed: a window that nobody touches costs nothing.
  while (!window.closing() && !(options.frames && frames_drawn >= *options.frames)) {
    double timeout = -1;
    extent = pixels_of(window);
    const bool visible = extent.width > 0 && extent.height > 0;
    if (options.frames || (dirty && visible)) {
      timeout = 0;
    } else if (playing && visible) {
      timeout = std::max(1e-3, std::chrono::duration<double>(next_slot - Clock::now()).count());
    }
    events.clear();
    window.wait(timeout, events);
    for (const WindowEvent& event : events) {
      switch (controls.handle(event, viewpoint, home, extent.width, extent.height)) {
        case Reply::quit:
          return;
        case Reply::toggle_pause:
          playing = !playing && show.changes();
          break;
        case Reply::redraw:
          dirty = true;
          break;
        case Reply::nothing:
          break;
      }
    }
    if (playing && (options.frames ? frames_drawn > 0 : Clock::now() >= next_slot)) {
      next_slot = Clock::now() + slow_slot;
      show.go_to(++slot);
      presenter.finish();
      drawn.update_marks(show.picture(), state);
      dirty = true;
    }
    extent = pixels_of(window);
    if (!dirty && !options.frames) continue;
    const double ratio = options.pixel_ratio.value_or(window.pixel_ratio());
    if (presenter.draw(drawn, views_from(viewpoint, options, show.picture(), extent, ratio), ratio)) {
      ++frames_drawn;
      dirty = false;
    } else if (extent.width == 0 || extent.height == 0) {
      window.wait(0.1, events);
    }
  }
}

}  // namespace palpa::viewer
