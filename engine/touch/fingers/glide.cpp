#include "touch/fingers/glide.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "shaders/touch/contacts/reach.h"
#include "touch/fingers/follow_math.hpp"
#include "touch/fingers/nearest_filled.hpp"

namespace palpa::touch {
namespace {

/// A sector that empties keeps its focus for this time.
constexpr std::uint32_t hold_us = 50000U;

constexpr float motion_s = 0.005F;  // the finger's own motion is that of its centroid, within this time
constexpr float full_turn = 6.2831853F;
constexpr float cutoff_hz = 4.0F;        // of the filter at rest,
constexpr float cutoff_per_m = 500.0F;   // plus this much per m/s of a focus relative to the finger
constexpr float speed_hz = 2.0F;         // cutoff for that speed
constexpr float most_glide_mps = 0.05F;  // largest speed of a focus relative to the finger
constexpr float astray_m = 0.01F;        // with no time between frames: a focus farther than this from its target
                                         // restarts there

/// The share of a step that a low-pass filter of this cutoff takes in a frame.
float low_pass(float hz, float frame_s) {
  float rate = full_turn * hz * frame_s;
  float share = rate / (1.0F + rate);
  return share;
}

/// The motion of a finger whose centroid went from one place to another: that of its velocity, plus most of the
/// centroid's motion beyond that. With no time between frames, it is the centroid's motion.
Float3 motion_of(Float3 from, Float3 to, Float3 velocity, float frame_s) {
  const float coasting_s = shader::seconds_of(coasting_us);
  const float coasts_s = frame_s < coasting_s ? frame_s : coasting_s;
  const Float3 expected = scaled(velocity, coasts_s);
  float most = frame_s / (frame_s + motion_s);
  const float share = frame_s > 0.0F ? most : 1.0F;
  return moved(expected, minus(minus(to, from), expected), share);
}

/// A vector that is fixed to a finger whose axes turn.
Float3 turned_along(Float3 v, PrincipalAxes from, PrincipalAxes to) {
  Float3 r = scaled(to.w1, dot3(from.w1, v));
  r = moved(r, to.w2, dot3(from.w2, v));
  return moved(r, to.w3, dot3(from.w3, v));
}

struct Gliding {
  Float3 place, speed;
};

/// One step of the One Euro filter (Casiez, Roussel and Vogel, CHI 2012) for a focus that the finger's motion alone
/// would have brought to `carried`, towards the place where its sector has it.
Gliding glide(Float3 carried, Float3 speed, Float3 target, float frame_s) {
  Gliding r;
  r.place = carried;
  r.speed = speed;
  const Float3 way = minus(target, carried);
  if (!(frame_s > 0.0F)) {
    if (dot3(way, way) > astray_m * astray_m) r.place = target;
    return r;
  }
  float rate = 1.0F / frame_s;
  r.speed = moved(speed, minus(scaled(way, rate), speed), low_pass(speed_hz, frame_s));
  float cutoff = cutoff_hz + cutoff_per_m * std::sqrt(dot3(r.speed, r.speed));
  float share = low_pass(cutoff, frame_s);
  float wanted = share * std::sqrt(dot3(way, way));
  float most = most_glide_mps * frame_s;
  if (wanted > most) {
    float shorter = share * (most / wanted);
    r.place = moved(carried, way, shorter);
  } else {
    r.place = moved(carried, way, share);
  }
  return r;
}

shader::vec4 vec4(const glm::vec3& v) {
  return {v.x, v.y, v.z, 0};
}

PrincipalAxes frame_of(const Float3& w1, const Float3& w3) {
  return {w1, cross3(w3, w1), w3, 0, 0, 0};
}

void glide_finger(const Track& track, Home& home, Finger& finger) {
  const auto count = static_cast<std::uint32_t>(finger.foci.size());
  const bool restart = track.since_us == follow_restart || home.foci != count;
  const float frame_s = shader::seconds_of(track.since_us);
  const Float3 centre = float3(finger.section.centroid), old_centre = float3(home.centre);
  const PrincipalAxes axes = frame_of(float3(finger.section.axes[0]), float3(finger.section.axes[2]));
  const PrincipalAxes old_axes = frame_of(float3(home.axis1), float3(home.axis3));
  const Float3 motion = motion_of(old_centre, minus(centre, track.joined), float3(home.velocity), frame_s);

  std::array<Focus, max_foci> copy;
  const std::span<const Focus> sectors = std::span(copy).first(count);
  std::copy(finger.foci.begin(), finger.foci.end(), copy.begin());
  for (std::uint32_t n = 0; n < count; ++n) {
    GlidingFocus& focus = home.focus[n];
    const bool empty = sectors[n].points == 0;
    const std::uint32_t near = nearest_filled(n, count, [&](std::uint32_t i) { return sectors[i].points != 0; });
    Float3 target = float3(sectors[near < count ? near : n].position);
    Gliding now{target, {0, 0, 0}};
    if (restart) {
      focus.empty_us = empty ? hold_us + 1 : 0;
    } else {
      const Float3 offset = minus({focus.x, focus.y, focus.z}, old_centre);
      const Float3 carried = moved(moved(old_centre, motion, 1), turned_along(offset, old_axes, axes), 1);
      focus.empty_us = empty ? us_after(focus.empty_us, track.since_us) : 0;
      if (empty && focus.empty_us <= hold_us) target = carried;
      now = glide(carried, {focus.speed_x, focus.speed_y, focus.speed_z}, target, frame_s);
    }
    focus = {now.place.x, now.place.y, now.place.z, focus.empty_us, now.speed.x, now.speed.y, now.speed.z};
    finger.foci[n].position = {now.place.x, now.place.y, now.place.z};
    finger.foci[n].held = empty && focus.empty_us <= hold_us;
  }
  finger.placed = true;
  home.centre = vec4(finger.section.centroid);
  home.velocity = track.velocity;
  home.axis1 = vec4(finger.section.axes[0]);
  home.axis3 = vec4(finger.section.axes[2]);
  home.foci = count;
}

}  // namespace

void glide_foci(const Tracks& tracks, Homes& homes, Touch& touch) {
  for (std::uint32_t f = 0; f < touch.finger_count; ++f)
    glide_finger(tracks.tracks[f], homes.homes[tracks.tracks[f].home], touch.fingers[f]);
}

}  // namespace palpa::touch
