#include "setup/tasks/nudge.hpp"

#include <fmt/format.h>

#include <glm/common.hpp>

#include "setup/tasks/calibrate.hpp"

namespace palpa::setup {

void Nudge::press(const NudgePress& press, double time_s) {
  if (end_ != End::none) return;
  apply(press);
  if (!touches_) return;
  touches_->nudge(offset());
  if (end_ == End::save) take_touch(time_s);
}

void Nudge::apply(const NudgePress& press) {
  switch (press.key) {
    case NudgeKey::left:
      return move({-1, 0, 0}, press.fine);
    case NudgeKey::right:
      return move({1, 0, 0}, press.fine);
    case NudgeKey::up:
      return move({0, 1, 0}, press.fine);
    case NudgeKey::down:
      return move({0, -1, 0}, press.fine);
    case NudgeKey::away:
      return move({0, 0, -1}, press.fine);
    case NudgeKey::nearer:
      return move({0, 0, 1}, press.fine);
    case NudgeKey::finer:
      fine_ = !fine_;
      break;
    case NudgeKey::back:
      steps_ = Vec3(0);
      break;
    case NudgeKey::save:
      end_ = End::save;
      break;
    case NudgeKey::leave:
      end_ = End::leave;
      break;
    case NudgeKey::wait:
      break;
  }
}

void Nudge::move(const Vec3& way, bool fine) {
  constexpr double most = farthest_nudge_m / fine_step_m;
  steps_ = glm::clamp(steps_ + way * (fine || fine_ ? 1.0 : step_m / fine_step_m), Vec3(-most), Vec3(most));
}

/// The next focus begins at its own place.
void Nudge::take_touch(double time_s) {
  hint_ = touches_->take(time_s);
  if (touches_->complete()) return;
  end_ = End::none;
  if (hint_.empty()) steps_ = Vec3(0);
}

std::string Nudge::why_unsaved() const {
  const std::string at = touches_ ? " at " + touches_->line() : "";
  return hint_.empty() ? "it ended before Enter was pressed" + at : fmt::format("it ended{}: {}", at, hint_);
}

std::string Nudge::place() const {
  const Vec3 mm = offset() * 1e3;
  return fmt::format("x {:+.1f}  y {:+.1f}  z {:+.1f} mm, step {} mm", mm.x, mm.y, mm.z, fine_ ? "0.1" : "1");
}

}  // namespace palpa::setup
