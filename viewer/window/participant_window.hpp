// The participant's window. It fills a monitor, and shows the objects where they are felt.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "viewer/app/app.hpp"
#include "viewer/render/offscreen.hpp"
#include "viewer/window/swapchain.hpp"
#include "viewer/window/window_surface.hpp"

namespace palpa::viewer {

class ParticipantWindow {
 public:
  /// On the monitor of that number, in addition to the window that waits for events.
  ParticipantWindow(const gpu::Device& device, std::size_t monitor);

  bool closing() const { return window_.closing(); }
  /// Takes the window's events. If the window was damaged, it is drawn again.
  void take(std::vector<WindowEvent>& events);
  /// Draws what `app` has for the participant, unless that is shown already: the pictures of both eyes, combined as the
  /// screen separates them. A picture is made when something changes, not at a fixed rate. Returns the window's size.
  Size show(const App& app);

 private:
  struct Shown {
    std::uint64_t surfaces = 0;
    Participant participant;
    bool hidden = false, dark = false, says_how_to_leave = false;
    Size size;
    bool operator==(const Shown&) const = default;
  };

  const gpu::Device* device_;
  Window window_;
  WindowSurface surface_;
  DrawnPicture drawn_;  ///< outlives the frames that draw it: the presenter's end waits for them
  Presenter presenter_;
  std::optional<Offscreen> eye_;
  std::optional<Shown> shown_;
};

}  // namespace palpa::viewer
