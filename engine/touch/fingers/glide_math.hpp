// The arithmetic of gliding foci. The rules are in docs/touch.md.
#pragma once

#include <cmath>
#include <cstdint>

#include "shaders/touch/contacts/reach.h"
#include "touch/fingers/exact.hpp"
#include "touch/fingers/foci_math.hpp"
#include "touch/fingers/follow_math.hpp"

namespace palpa::touch {

/// A focus as it was played.
struct GlidingFocus {
  float x;  // world
  float y;
  float z;
  std::uint32_t empty_us;  // time since its sector has had contacts
  float speed_x;           // m/s, smoothed: speed of its sector's target relative to the finger
  float speed_y;
  float speed_z;
};

/// The data kept of a finger's foci from frame to frame, at its track's home.
struct Home {
  shader::vec4 centre;    // of the contacts when it was last seen
  shader::vec4 velocity;  // m/s
  shader::vec4 axis1;
  shader::vec4 axis3;
  std::uint32_t foci;
  GlidingFocus focus[foci_most];
};

/// A sector that empties keeps its focus for this time.
inline constexpr std::uint32_t hold_us = 50000U;

inline constexpr float motion_s = 0.005F;  // the finger's own motion is that of its centroid, within this time
inline constexpr float full_turn = 6.2831853F;
inline constexpr float cutoff_hz = 4.0F;        // of the filter at rest,
inline constexpr float cutoff_per_m = 500.0F;   // plus this much per m/s of a focus relative to the finger
inline constexpr float speed_hz = 2.0F;         // cutoff for that speed
inline constexpr float most_glide_mps = 0.05F;  // largest speed of a focus relative to the finger
inline constexpr float astray_m = 0.01F;  // with no time between frames: a focus farther than this from its target
                                          // restarts there

/// The share of a step that a low-pass filter of this cutoff takes in a frame.
inline float low_pass(float hz, float frame_s) {
  float rate = full_turn * hz * frame_s;
  float share = rate / (1.0F + rate);
  return share;
}

/// The motion of a finger whose centroid went from one place to another: that of its velocity, plus most of the
/// centroid's motion beyond that. With no time between frames, it is the centroid's motion.
inline Float3 motion_of(Float3 from, Float3 to, Float3 velocity, float frame_s) {
  const float coasting_s = shader::seconds_of(coasting_us);
  const float coasts_s = frame_s < coasting_s ? frame_s : coasting_s;
  const Float3 expected = scaled(velocity, coasts_s);
  float most = frame_s / (frame_s + motion_s);
  const float share = frame_s > 0.0F ? most : 1.0F;
  return moved(expected, minus(minus(to, from), expected), share);
}

/// A vector that is fixed to a finger whose axes turn.
inline Float3 turned_along(Float3 v, PrincipalAxes from, PrincipalAxes to) {
  Float3 r = scaled(to.w1, dot3(from.w1, v));
  r = moved(r, to.w2, dot3(from.w2, v));
  return moved(r, to.w3, dot3(from.w3, v));
}

struct Gliding {
  Float3 place, speed;
};

/// One step of the One Euro filter (Casiez, Roussel and Vogel, CHI 2012) for a focus that the finger's motion alone
/// would have brought to `carried`, towards the place where its sector has it.
inline Gliding glide(Float3 carried, Float3 speed, Float3 target, float frame_s) {
  Gliding r;
  r.place = carried;
  r.speed = speed;
  const Float3 way = minus(target, carried);
  if (!(frame_s > 0.0F)) {
    if (dot3(way, way) > product(astray_m, astray_m)) r.place = target;
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

}  // namespace palpa::touch
