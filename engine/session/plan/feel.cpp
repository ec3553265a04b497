#include "session/plan/feel.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <limits>
#include <utility>

namespace palpa::session {
namespace {

/// Velocities are filtered as those of tracks (touch/fingers/follow.hpp).
constexpr double velocity_time_s = 30e-3;
/// Gains that come from an older frame are reached in this time.
constexpr double most_way_s = 0.1;

std::uint32_t slots_in(double seconds, double slot_s) {
  return static_cast<std::uint32_t>(std::lround(std::clamp(seconds / slot_s, 1.0, 1e6)));
}

double at_rest(double gain, std::span<const geometry::DepthForce> stiffness, std::optional<double> press_depth_m) {
  return gain * std::sqrt(geometry::force_at(stiffness, press_depth_m.value_or(0)));
}

/// What holds in all slots of the frame becomes the voice's own gain: all of it, or the force beside vibrations.
void give(array::Course course, array::Voice& voice, double slot_s) {
  if (!course.changes()) {
    voice.gain *= array::modulate(course, 0, slot_s);
    return;
  }
  if (course.slots == 0) {
    voice.gain *= std::sqrt(course.to.force);
    course.from.force = course.to.force = 1;
  }
  voice.course = std::move(course);
}

}  // namespace

double resting_gain(const geometry::Haptics& haptics, double usual) {
  const std::span<const geometry::DepthForce> stiffness =
      haptics.stiffness ? *haptics.stiffness : std::span<const geometry::DepthForce>();
  return at_rest(haptics.intensity.value_or(usual), stiffness, haptics.press_depth_m);
}

bool needs_depths(std::span<const geometry::Solid> solids) {
  return std::ranges::any_of(
      solids, [](const geometry::Solid& solid) { return solid.haptics.clicks() || solid.haptics.stiffness; });
}

bool carries(const GainPace& pace, double hz) {
  return hz == 0 || (!pace.steady && pace.slot_s * hz <= longest_slot * (1 + 1e-9));
}

double fastest_hz(const array::Texture& texture) {
  return texture.high > 0 ? array::high_hz : texture.low > 0 ? array::low_hz : 0;
}

Feel::Feel(std::span<const geometry::Solid> solids, std::span<const SolidHaptics> resolved, const GainPace& pace,
           double hold_s)
    : pace_(pace), touches_(solids, hold_s) {
  solids_.reserve(solids.size());
  for (std::size_t s = 0; s < solids.size(); ++s) {
    const geometry::Haptics& haptics = solids[s].haptics;
    Own& own = solids_.emplace_back();
    own.gain = resolved[s].voice.gain;
    own.press_depth_m = haptics.press_depth_m;
    own.grain_m = haptics.grain_m.value_or(geometry::default_grain_m);
    if (haptics.click) set(own, *haptics.click);
    if (haptics.texture) own.texture = {(*haptics.texture)[0], (*haptics.texture)[1], (*haptics.texture)[2]};
    if (!haptics.stiffness) continue;
    const std::size_t rows = std::min(haptics.stiffness->size(), geometry::most_stiffness_rows);
    for (const geometry::DepthForce& row : std::span(*haptics.stiffness).first(rows))
      own.stiffness.push_back(row);
  }
  known_.reserve(most_touches);
}

void Feel::set(Own& own, const geometry::Click& click) const {
  own.click = carries(pace_, click.hz) ? click : geometry::Click{.burst_s = 0};
}

bool Feel::vibrates(const Own& own) const {
  return own.texture && carries(pace_, fastest_hz(*own.texture));
}

bool Feel::Own::silence_first() const {
  return at_rest(gain, stiffness, press_depth_m) > most_resting_gain;
}

void Feel::set_pose(std::uint32_t solid, const Transform& T_world_rest) {
  solids_[solid].T_rest_world = glm::inverse(T_world_rest);
}

void Feel::change(std::uint32_t solid, const FeelChange& change) {
  Own& own = solids_[solid];
  if (change.click) set(own, *change.click);
  if (change.stiffness) own.stiffness = *change.stiffness;
  if (change.texture) own.texture = change.texture;
}

void Feel::shape(const touch::Touch& touch, double time_s, const Following& following, const Vec3& aim,
                 array::Schedule& schedule) {
  const Frame frame{time_s, schedule.slot_s, following.first_slot, aim};
  if (following.follows) {
    touches_.update(touch, time_s, following.hands);
    forget_ended();
  }
  for (std::uint32_t f = 0; f < touch.finger_count; ++f) {
    const touch::Finger& finger = touch.fingers[f];
    const Own& own = solids_[finger.solid];
    if (!own.any()) continue;
    array::Voice& voice = schedule.voices[f];
    if (following.follows) {
      Known& known = this->known(finger.id);
      give(course_of(own, finger, frame, known), voice, frame.slot_s);
      if (vibrates(own)) voice.modulation_hz = 0;
      if (own.clicks()) click(own, finger, touches_.held()[f], frame, known, voice);
      known.seen_s = time_s;
    } else {
      const array::Course::Values now{.force = own.force(double{finger.depth_m})};
      give({.from = now, .to = now, .texture = own.texture.value_or(array::Texture())}, voice, frame.slot_s);
    }
  }
}

void Feel::forget_ended() {
  for (const EndedTouch& ended : touches_.ended())
    std::erase_if(known_, [&](const Known& known) { return known.id == ended.last.id; });
}

Feel::Known& Feel::known(std::uint32_t id) {
  const auto found = std::ranges::find(known_, id, &Known::id);
  return found != known_.end() ? *found : known_.emplace_back(Known{.id = id});
}

/// From what the course before has in the first slot to the values of this frame.
array::Course Feel::course_of(const Own& own, const touch::Finger& finger, const Frame& frame, Known& known) {
  const Vec3 place = transform_point(own.T_rest_world, Vec3(finger.section.centroid));
  const double since_s = frame.time_s - known.seen_s.value_or(frame.time_s);
  if (since_s > 0)
    known.velocity += ((place - known.place) / since_s - known.velocity) * (since_s / (since_s + velocity_time_s));
  known.place = place;
  const double speed = std::min(1.0, glm::length(known.velocity) / full_texture_speed_m_s);
  const array::Course::Values now{.force = own.force(double{finger.depth_m}),
                                  .motion = vibrates(own) ? speed * speed * (3 - 2 * speed) : 0,
                                  .place = place / own.grain_m};
  array::Course course{.from = now, .to = now, .texture = vibrates(own) ? *own.texture : array::Texture()};
  if (frame.first_slot) {
    course.first_slot = *frame.first_slot;
    if (known.seen_s) {
      course.from = known.course.at(*frame.first_slot);
      course.slots = slots_in(std::min(since_s, most_way_s), frame.slot_s);
    }
  }
  return known.course = course;
}

void Feel::click(const Own& own, const touch::Finger& finger, const HeldTouch& held, const Frame& frame, Known& known,
                 array::Voice& voice) {
  if ((held.presses || held.lifts) && frame.time_s - known.clicked_s >= between_clicks_s) {
    known.clicked_s = frame.time_s;
    known.click_slot = frame.first_slot;
  }
  const geometry::Click& click = own.click;
  const bool silence_first = own.silence_first();
  const double silence_s = silence_first ? silence_before_click_s : 0;
  const double since_s = frame.time_s - known.clicked_s;
  if (since_s >= between_clicks_s) return;
  array::Course course;
  double gain = 1;
  if (frame.first_slot && known.click_slot) {
    course.first_slot = *frame.first_slot;
    course.begin_slot = *known.click_slot + (silence_first ? slots_in(silence_s, frame.slot_s) : 0);
    course.end_slot = course.begin_slot + slots_in(click.burst_s, frame.slot_s);
    if (*frame.first_slot >= course.end_slot) return;
  } else {
    if (since_s >= silence_s + click.burst_s) return;
    gain = since_s < silence_s ? 0 : 1;
  }
  voice.foci.assign(1, Vec3(finger.section.centroid) + frame.aim);
  voice.order.assign(1, 0);
  voice.foci_per_slot = 1;
  voice.modulation_hz = click.hz;
  voice.modulation = array::Modulation::pressure_sine;
  voice.gain = gain;
  voice.course = course;
}

}  // namespace palpa::session
