// What a session is made of: each value stands here once.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "acoustics/field/focus_field.hpp"
#include "array/drive.hpp"
#include "array/layout.hpp"
#include "geometry/solid.hpp"
#include "sensing/camera.hpp"
#include "session/links/safe_link.hpp"
#include "session/plan/scheduler.hpp"
#include "session/watch/events.hpp"
#include "touch/types.hpp"

namespace palpa::session {

struct SessionSetting {
  std::string scene = "scene";  ///< where the solids are from, for messages
  std::vector<geometry::Solid> solids;
  std::vector<sensing::Camera> cameras;  ///< none: skin comes as points; else as their depth frames
  array::Layout layout;                  ///< as posed in the world; without transducers nothing is driven
  touch::Parameters touch;
  ScheduleOptions schedule;
  array::DriveOptions drive;
  /// What spectra and Tune::all have of a focus, in the place of the layout's field in free air; it outlives the
  /// session.
  const acoustics::FocusField* field = nullptr;
  /// Nothing: nobody asks for events. Then fingers are no deeper than delta, which saves looking at the skin below.
  std::optional<EventOptions> events = EventOptions{};
  /// Fingers keep their ids from frame to frame, and as the next two say their axes and foci. Off: each frame stands
  /// alone.
  bool follow = true;
  touch::Axes axes = touch::Axes::steady;
  touch::Smoothing smoothing = touch::Smoothing::one_euro;
  /// What a frame shows lasts that long after its capture if no other comes: then comes silence, and fingers let go.
  double hold_s = 0.1;
  /// run() may lengthen it to longest_auto_hold_s where frames are late whatever is shed (session/watch/effort.hpp).
  bool lengthens_hold = false;
  Safety safety;  ///< around whatever link it runs to
  /// It never runs by itself: a frame may then have far more skin in the shell than a loop has room for.
  bool frame_by_frame = false;

  /// Whether it has all that run() needs.
  bool live() const { return !frame_by_frame && !cameras.empty() && !layout.transducers.empty(); }
};

}  // namespace palpa::session
