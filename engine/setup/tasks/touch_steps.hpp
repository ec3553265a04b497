// Foci that sound one after the other, and that a person touches: what the keys of `palpa calibrate` change.
#pragma once

#include <string>

#include "base/math.hpp"

namespace palpa::setup {

/// Used by the threads of the source, of the method and of the keys.
class TouchSteps {
 public:
  virtual ~TouchSteps() = default;
  /// The current focus is at this offset from its first place, metres, world.
  virtual void nudge(const Vec3& offset) = 0;
  /// The fingertip touches the current focus, in the frame of that time: the next one follows. Returns what keeps that
  /// from being so; empty: nothing.
  virtual std::string take(double time_s) = 0;
  /// "focus 2 of 4"; empty after the last.
  virtual std::string line() const = 0;
  /// Whether all were touched.
  virtual bool complete() const = 0;
};

}  // namespace palpa::setup
