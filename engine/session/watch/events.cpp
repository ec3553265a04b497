#include "session/watch/events.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

namespace palpa::session {

EventTracker::EventTracker(std::span<const geometry::Solid> solids, const EventOptions& options, double hold_s)
    : options_(options), touches_(solids, hold_s) {
  told_.reserve(most_touches);
  events_.reserve(3 * most_touches);
}

std::span<const Event> EventTracker::update(const touch::Touch& touch, double time_s,
                                            std::optional<std::uint32_t> hands) {
  touches_.update(touch, time_s, hands);
  release_ended();
  for (const HeldTouch& held : touches_.held())
    follow(held);
  return events_;
}

std::span<const Event> EventTracker::expire() {
  touches_.expire();
  release_ended();
  return events_;
}

std::span<const Event> EventTracker::end() {
  touches_.end();
  release_ended();
  return events_;
}

void EventTracker::release_ended() {
  events_.clear();
  for (const EndedTouch& ended : touches_.ended()) {
    tell(EventKind::release, ended.last, ended.time_s);
    std::erase_if(told_, [&](const Told& told) { return told.id == ended.last.id; });
  }
}

void EventTracker::follow(const HeldTouch& held) {
  const auto told = std::ranges::find(told_, held.id, &Told::id);
  if (told == told_.end()) {
    told_.push_back({held.id, held.depth_m, held.centroid});
    tell(EventKind::touch, held, held.seen_s);
  } else if (glm::distance(held.centroid, told->centroid) >= options_.move_m ||
             std::abs(held.depth_m - told->depth_m) >= options_.move_m) {
    *told = {held.id, held.depth_m, held.centroid};
    tell(EventKind::move, held, held.seen_s);
  }
  if (!held.presses) return;
  *std::ranges::find(told_, held.id, &Told::id) = {held.id, held.depth_m, held.centroid};
  tell(EventKind::press, held, held.seen_s);
}

void EventTracker::tell(EventKind kind, const HeldTouch& held, double time_s) {
  events_.push_back({kind, time_s, held.solid, held.id, held.depth_m, held.centroid});
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
