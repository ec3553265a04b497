#include "session/watch/events.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace palpa::session {
namespace {

/// Maximum number of lost fingers that are waited for. If a source's clock stands still, ids that never return must not
/// fill the memory.
constexpr std::size_t most_held = 4 * std::size_t{touch::max_fingers};

}  // namespace

EventTracker::EventTracker(std::span<const geometry::Solid> solids, const EventOptions& options, double hold_s)
    : options_(options), hold_s_(hold_s), grace_s_(hold_s / 2) {
  press_depth_m_.reserve(solids.size());
  for (const geometry::Solid& solid : solids)
    press_depth_m_.push_back(solid.haptics.press_depth_m);
  held_.reserve(most_held + touch::max_fingers);
  events_.reserve(2 * (most_held + touch::max_fingers));
}

std::span<const Event> EventTracker::update(const touch::Touch& touch, double time_s) {
  events_.clear();
  if (begun_ && time_s < last_s_) {
    release_all();
  } else if (begun_ && time_s > last_s_ + hold_s_) {
    for (Held& held : held_)
      held.seen = false;
    release_missing(last_s_ + hold_s_);
  }
  begun_ = true;
  last_s_ = time_s;

  for (Held& held : held_)
    held.seen = false;
  const std::span<const touch::Finger> fingers = std::span(touch.fingers).first(touch.finger_count);
  for (const touch::Finger& finger : fingers) {
    if (Held* held = held_of(finger.id)) held->seen = true;
  }
  release_missing(time_s);
  for (const touch::Finger& finger : fingers) {
    Held* held = held_of(finger.id);
    const bool fresh = !held || held->solid != finger.solid;
    if (held && fresh) {  // it has left the previous solid
      release(*held, time_s);
      held_.erase(held_.begin() + (held - held_.data()));
    }
    if (fresh) held = &held_.emplace_back(Held{.id = finger.id, .solid = finger.solid, .seen = true});
    follow(*held, finger, time_s, fresh);
  }
  return events_;
}

std::span<const Event> EventTracker::expire() {
  events_.clear();
  for (Held& held : held_)
    held.seen = false;
  release_missing(last_s_ + hold_s_);
  return events_;
}

std::span<const Event> EventTracker::end() {
  events_.clear();
  release_all();
  return events_;
}

void EventTracker::release_all() {
  for (const Held& held : held_)
    release(held, last_s_);
  held_.clear();
}

EventTracker::Held* EventTracker::held_of(std::uint32_t id) {
  const auto held = std::find_if(held_.begin(), held_.end(), [&](const Held& other) { return other.id == id; });
  return held == held_.end() ? nullptr : &*held;
}

/// Releases fingers that have been missing for the grace time, in the order in which they were lost.
void EventTracker::release_missing(double time_s) {
  const std::size_t begin = events_.size();
  const std::size_t missing =
      static_cast<std::size_t>(std::count_if(held_.begin(), held_.end(), [](const Held& held) { return !held.seen; }));
  std::size_t too_many = missing > most_held ? missing - most_held : 0;
  std::erase_if(held_, [&](const Held& held) {
    if (held.seen) return false;
    const double until_s = held.seen_s + grace_s_;
    if (until_s > time_s && too_many == 0) return false;
    if (too_many > 0) --too_many;
    release(held, std::min(until_s, time_s));
    return true;
  });
  std::stable_sort(events_.begin() + static_cast<std::ptrdiff_t>(begin), events_.end(),
                   [](const Event& a, const Event& b) { return a.time_s < b.time_s; });
}

void EventTracker::release(const Held& held, double time_s) {
  events_.push_back({EventKind::release, time_s, held.solid, held.id, held.depth, held.centroid});
}

void EventTracker::follow(Held& held, const touch::Finger& finger, double time_s, bool fresh) {
  held.seen_s = time_s;
  held.depth = finger.depth_m;
  held.centroid = finger.section.centroid;
  if (fresh) {
    tell(EventKind::touch, held, time_s);
  } else if (glm::distance(held.centroid, held.told_centroid) >= options_.move_m ||
             std::abs(held.depth - held.told_depth) >= options_.move_m) {
    tell(EventKind::move, held, time_s);
  }
  if (held.solid >= press_depth_m_.size() || !press_depth_m_[held.solid]) return;
  const bool pressed = presses(held.pressed, held.depth, *press_depth_m_[held.solid], options_.rearm);
  if (pressed && !held.pressed) tell(EventKind::press, held, time_s);
  held.pressed = pressed;
}

void EventTracker::tell(EventKind kind, Held& held, double time_s) {
  held.told_depth = held.depth;
  held.told_centroid = held.centroid;
  events_.push_back({kind, time_s, held.solid, held.id, held.depth, held.centroid});
}

void write_event_line(const Event& event, std::span<const std::string> solid_names, JsonWriter& json) {
  json.clear();
  json.begin_object(JsonWriter::Style::compact)
      .member("event", word_of(event_words, event.kind))
      .member("time_s", event.time_s);
  json.key("solid").value(event.solid < solid_names.size() ? std::string_view(solid_names[event.solid]) : "");
  json.member("finger", event.finger).member("depth_m", event.depth_m).member("centroid_m", event.centroid);
  json.end_object();
}

}  // namespace palpa::session
