// The keys of `palpa calibrate --nudge` and --by-touch, on a terminal and in the viewer's window: they move a focus
// until it is felt, and take touches of foci that sound one after the other.
#pragma once

#include <string>

#include "base/math.hpp"
#include "setup/tasks/touch_steps.hpp"

namespace palpa::setup {

enum class NudgeKey { left, right, up, down, away, nearer, finer, back, save, leave, wait };

struct NudgePress {
  NudgeKey key;
  bool fine = false;  ///< with shift
  bool operator==(const NudgePress&) const = default;
};

/// What the keys have done so far.
class Nudge {
 public:
  enum class End { none, save, leave };

  /// `touches`: null if a single focus is moved.
  explicit Nudge(TouchSteps* touches = nullptr) : touches_(touches) {}

  /// `time_s`: of the newest frame. `save` goes from focus to focus, and only after the last one it is the end. The
  /// first end counts: later keys have no effect.
  void press(const NudgePress& press, double time_s);

  /// Metres in the world.
  Vec3 offset() const { return steps_ * fine_step_m; }
  End end() const { return end_; }
  /// What kept the last touch from being taken; empty: nothing.
  const std::string& hint() const { return hint_; }
  /// Why a run that ended by itself saves nothing: "it ended before Enter was pressed at focus 2 of 8", or why the last
  /// Enter was refused.
  std::string why_unsaved() const;
  /// "x +1.0  y +0.0  z +0.0 mm, step 1 mm"
  std::string place() const;

 private:
  static constexpr double step_m = 1e-3, fine_step_m = 1e-4;
  void apply(const NudgePress& press);
  void move(const Vec3& way, bool fine);
  void take_touch(double time_s);

  TouchSteps* touches_;
  Vec3 steps_{0};  ///< whole fine steps, so that moving back ends exactly at the start
  bool fine_ = false;
  End end_ = End::none;
  std::string hint_;
};

}  // namespace palpa::setup
