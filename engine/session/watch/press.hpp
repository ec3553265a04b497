// When a finger presses a solid: the rule of events and of clicks.
#pragma once

namespace palpa::session {

/// A finger presses from this share of the press depth on, if it pressed before.
inline constexpr double default_rearm = 0.8;

/// Whether a finger presses, from whether it did in the frame before.
inline bool presses(bool pressed, double depth_m, double press_depth_m, double rearm = default_rearm) {
  return depth_m >= press_depth_m || (pressed && depth_m >= rearm * press_depth_m);
}

}  // namespace palpa::session
