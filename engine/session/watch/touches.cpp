#include "session/watch/touches.hpp"

#include <algorithm>
#include <glm/geometric.hpp>

namespace palpa::session {
namespace {

/// Maximum number of lost fingers that are waited for. If a source's clock stands still, ids that never return must not
/// fill the memory.
constexpr std::size_t most_missing = most_touches - touch::max_fingers;

}  // namespace

Touches::Touches(std::span<const geometry::Solid> solids, double hold_s) : hold_s_(hold_s), grace_s_(hold_s / 2) {
  press_depth_m_.reserve(solids.size());
  for (const geometry::Solid& solid : solids)
    press_depth_m_.push_back(solid.haptics.press_depth_m);
  held_.reserve(most_touches);
  lost_.reserve(touch::max_fingers);
  held_now_.reserve(touch::max_fingers);
  ended_.reserve(2 * most_touches);
}

void Touches::update(const touch::Touch& touch, double time_s, std::optional<std::uint32_t> hands) {
  const std::uint32_t shown = hands.value_or(0);
  ended_.clear();
  held_now_.clear();
  for (Held& held : held_)
    held.seen = false;
  if (begun_ && time_s < last_s_) {
    for (const Held& held : held_)
      end(held, last_s_);
    held_.clear();
    lost_.clear();
  } else if (begun_ && time_s > last_s_ + hold_s_) {
    end_missing(last_s_ + hold_s_);
  }
  begun_ = true;
  last_s_ = time_s;

  const std::span<const touch::Finger> fingers = std::span(touch.fingers).first(touch.finger_count);
  for (const touch::Finger& finger : fingers) {
    Held* const held = held_of(finger.id);
    if (held) held->seen = held->solid == finger.solid;
    if (held && !held->seen) {  // it has left the previous solid
      end(*held, time_s);
      held_.erase(held_.begin() + (held - held_.data()));
    }
  }
  end_missing(time_s);
  for (const touch::Finger& finger : fingers) {
    Held* held = held_of(finger.id);
    const bool begins = held == nullptr;
    if (begins) held = &held_.emplace_back();
    held->begins = begins;
    follow(*held, finger, time_s, shown);
  }
  // What has not come back although its hand has.
  for (Held& held : held_)
    held.elsewhere = !held.seen && (held.elsewhere || shown >= held.hands);
  for (LostPress& lost : lost_)
    lost.since_s = hands ? lost.since_s : time_s;
  std::erase_if(lost_,
                [&](const LostPress& lost) { return shown >= lost.hands || time_s > lost.since_s + lost_press_s; });
}

void Touches::expire() {
  ended_.clear();
  held_now_.clear();
  for (Held& held : held_)
    held.seen = false;
  end_missing(last_s_ + hold_s_);
}

void Touches::end() {
  ended_.clear();
  held_now_.clear();
  for (const Held& held : held_)
    end(held, last_s_);
  held_.clear();
}

void Touches::take_over(const Touches& other) {
  lost_ = other.lost_;
  for (const Held& held : other.held_)
    keep_press(held);
  for (LostPress& lost : lost_)
    lost.solid.reset();
}

Touches::Held* Touches::held_of(std::uint32_t id) {
  const auto held = std::ranges::find(held_, id, &Held::id);
  return held == held_.end() ? nullptr : &*held;
}

/// Ends touches whose fingers have been missing for the grace time.
void Touches::end_missing(double time_s) {
  const auto missing = static_cast<std::size_t>(std::ranges::count(held_, false, &Held::seen));
  std::size_t too_many = missing > most_missing ? missing - most_missing : 0;
  std::erase_if(held_, [&](const Held& held) {
    if (held.seen) return false;
    const double until_s = held.seen_s + grace_s_;
    if (until_s > time_s && too_many == 0) return false;
    if (too_many > 0) --too_many;
    end(held, std::min(until_s, time_s));
    return true;
  });
  // In the order of their times, and without memory for it.
  const auto before = [](double time, const EndedTouch& ended) { return time < ended.time_s; };
  for (auto at = ended_.begin(); at != ended_.end(); ++at)
    std::rotate(std::upper_bound(ended_.begin(), at, at->time_s, before), at, at + 1);
}

void Touches::end(const Held& held, double time_s) {
  ended_.push_back({held, time_s});
  keep_press(held);
}

void Touches::keep_press(const Held& held) {
  if (!held.pressed || held.elsewhere) return;
  if (lost_.size() == touch::max_fingers) lost_.erase(lost_.begin());
  lost_.push_back({held.solid, held.seen_s, held.centroid, held.hands});
}

/// Whether the finger, which is new, was lost while it pressed.
bool Touches::take_press(const touch::Finger& finger) {
  const auto is_near = [&](const glm::vec3& centroid) {
    return glm::distance(centroid, finger.section.centroid) <= static_cast<float>(lost_press_m);
  };
  const auto missing = std::ranges::find_if(held_, [&](const Held& held) {
    return !held.seen && held.pressed && !held.elsewhere && held.solid == finger.solid && is_near(held.centroid);
  });
  if (missing != held_.end()) {
    missing->pressed = false;
    return true;
  }
  const auto lost = std::ranges::find_if(lost_, [&](const LostPress& press) {
    return press.solid.value_or(finger.solid) == finger.solid && last_s_ <= press.since_s + lost_press_s &&
           is_near(press.centroid);
  });
  if (lost == lost_.end()) return false;
  lost_.erase(lost);
  return true;
}

void Touches::follow(Held& held, const touch::Finger& finger, double time_s, std::uint32_t hands) {
  const bool before = held.begins ? take_press(finger) : held.pressed;
  held.id = finger.id;
  held.solid = finger.solid;
  held.seen_s = time_s;
  held.depth_m = finger.depth_m;
  held.centroid = finger.section.centroid;
  held.seen = true;
  held.hands = hands;
  const std::optional<double> press_depth_m =
      finger.solid < press_depth_m_.size() ? press_depth_m_[finger.solid] : std::nullopt;
  held.pressed = press_depth_m && finger.depth_m >= (before ? press_rearm : 1) * *press_depth_m;
  held.presses = held.pressed && !before;
  held.lifts = before && !held.pressed && !held.begins;  // the touch that pressed has ended
  held_now_.push_back(held);
}

}  // namespace palpa::session
