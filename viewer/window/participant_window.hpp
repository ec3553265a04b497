// The participant's window: all of a monitor, on which the objects stand where they are felt.
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
  /// On the monitor of that number, beside the window that waits for events.
  ParticipantWindow(const gpu::Device& device, std::size_t monitor);

  bool closing() const { return window_.closing(); }
  /// What happened to it; where it was damaged it is drawn anew.
  void take(std::vector<WindowEvent>& events);
  /// Draws what `app` has for the participant, where that is not what is there already: both eyes, as the screen tells
  /// them apart. A picture is made when something changes, not at a rate.
  void show(const App& app);

 private:
  struct Shown {
    std::uint64_t surfaces = 0;
    Participant participant;
    bool hidden = false, dark = false;
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
