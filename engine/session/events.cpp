#include "session/events.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace palpa::session {
namespace {

/// More lost fingers than this are not waited for: ids that never come twice must not fill the memory of a source whose
/// clock stands still.
constexpr std::size_t most_held = 4 * std::size_t{touch::max_fingers};

}  // namespace

EventTracker::EventTracker(std::span<const geometry::Solid> solids, const EventOptions& options, double hold_s)
    : options_(options), hold_s_(hold_s), grace_s_(hold_s / 2) {
  press_depth_m_.reserve(solids.size());
  for (const geometry::Solid& solid : solids)
    press_depth_m_.push_back(solid.haptics.press_depth_m);
  held_.reserve(most_held + touch::max_fingers);
  known_.reserve(touch::max_fingers);
  events_.reserve(2 * (most_held + touch::max_fingers));
}

std::span<const Event> EventTracker::update(const touch::Touch& touch, double time_s) {
  events_.clear();
  if (begun_ && time_s < last_s_) {
    for (Held& held : held_)
      held.seen_s += time_s - last_s_;
  } else if (begun_ && time_s > last_s_ + hold_s_) {
    for (Held& held : held_)
      held.seen = false;
    release_missing(last_s_ + hold_s_);
  }
  begun_ = true;
  last_s_ = time_s;

  adopt(touch);
  release_missing(time_s);
  for (std::uint32_t f = 0; f < touch.finger_count; ++f) {
    const touch::Finger& finger = touch.fingers[f];
    const auto known = std::find_if(held_.begin(), held_.end(), [&](const Held& held) {
      return held.seen && held.current == finger.id && held.solid == finger.solid;
    });
    if (known != held_.end()) {
      follow(*known, finger, time_s, false);
      continue;
    }
    // The same finger on another solid has left the one before.
    const auto elsewhere = std::find_if(held_.begin(), held_.end(),
                                        [&](const Held& held) { return held.seen && held.current == finger.id; });
    if (elsewhere != held_.end()) {
      release(*elsewhere, time_s);
      held_.erase(elsewhere);
    }
    held_.push_back({.id = finger.id, .current = finger.id, .solid = finger.solid, .seen = true});
    follow(held_.back(), finger, time_s, true);
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
  for (const Held& held : held_)
    release(held, last_s_);
  held_.clear();
  return events_;
}

/// Marks who is seen in this frame: by the id that was told, else by the newest id, and then, for ids that are new,
/// lost fingers of the same solid, each the nearest that is left.
void EventTracker::adopt(const touch::Touch& touch) {
  known_.assign(touch.finger_count, false);
  for (Held& held : held_)
    held.seen = false;
  const auto recognise = [&](auto same) {
    for (std::uint32_t f = 0; f < touch.finger_count; ++f) {
      for (Held& held : held_) {
        if (known_[f] || held.seen || !same(held, touch.fingers[f].id)) continue;
        held.seen = known_[f] = true;
        held.current = touch.fingers[f].id;
      }
    }
  };
  recognise([](const Held& held, std::uint32_t id) { return held.id == id; });
  recognise([](const Held& held, std::uint32_t id) { return held.current == id; });
  for (std::uint32_t f = 0; f < touch.finger_count; ++f) {
    if (known_[f]) continue;
    const touch::Finger& finger = touch.fingers[f];
    float closest = reach_m;
    Held* nearest = nullptr;
    for (Held& held : held_) {
      if (held.seen || held.solid != finger.solid) continue;
      const float apart = glm::distance(held.centroid, finger.section.centroid);
      if (apart > closest) continue;
      closest = apart;
      nearest = &held;
    }
    if (!nearest) continue;
    nearest->seen = true;
    nearest->current = finger.id;
  }
}

/// Releases who has been missing for the grace, those first who were lost first.
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
  const double press_m = *press_depth_m_[held.solid];
  if (held.armed && held.depth >= press_m) {
    held.armed = false;
    tell(EventKind::press, held, time_s);
  } else if (held.depth < options_.rearm * press_m) {
    held.armed = true;
  }
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
