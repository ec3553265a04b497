// The arithmetic of gliding foci, for glide.comp and its twin; see exact_math.h. The rules are in docs/touch.md.
#ifndef PALPA_SHADERS_GLIDE_MATH_H
#define PALPA_SHADERS_GLIDE_MATH_H
#include "shaders/touch/follow/follow_math.h"
PALPA_SHADER_BEGIN

// A sector that empties keeps its focus for this time.
PALPA_CONST hold_us = 50000u;

PALPA_FLOAT motion_s = 0.005f;  // the finger's own motion is that of its centroid, within this time
PALPA_FLOAT full_turn = 6.2831853f;
PALPA_FLOAT cutoff_hz = 4.0f;        // of the filter at rest,
PALPA_FLOAT cutoff_per_m = 500.0f;   // plus this much per m/s of a focus relative to the finger
PALPA_FLOAT speed_hz = 2.0f;         // cutoff for that speed
PALPA_FLOAT most_glide_mps = 0.05f;  // largest speed of a focus relative to the finger
PALPA_FLOAT astray_m = 0.01f;        // with no time between frames: a focus farther than this from its target restarts
                                     // there

// The share of a step that a low-pass filter of this cutoff takes in a frame.
PALPA_FN float low_pass(float hz, float frame_s) {
  PALPA_EXACT float rate = full_turn * hz * frame_s;
  PALPA_EXACT float share = rate / (1.0f + rate);
  return share;
}

// The motion of a finger whose centroid went from one place to another: that of its velocity, plus most of the
// centroid's motion beyond that. With no time between frames, it is the centroid's motion.
PALPA_FN Float3 motion_of(Float3 from, Float3 to, Float3 velocity, float frame_s) {
  const float coasting_s = in_seconds(coasting_us);
  const float coasts_s = frame_s < coasting_s ? frame_s : coasting_s;
  const Float3 expected = scaled(velocity, coasts_s);
  PALPA_EXACT float most = frame_s / (frame_s + motion_s);
  const float share = frame_s > 0.0f ? most : 1.0f;
  return moved(expected, minus(minus(to, from), expected), share);
}

// A vector that is fixed to a finger whose axes turn.
PALPA_FN Float3 turned_along(Float3 v, Axes from, Axes to) {
  Float3 r = scaled(to.w1, dot3(from.w1, v));
  r = moved(r, to.w2, dot3(from.w2, v));
  return moved(r, to.w3, dot3(from.w3, v));
}

struct Gliding {
  Float3 place, speed;
};

// One step of the One Euro filter (Casiez, Roussel and Vogel, CHI 2012) for a focus that the finger's motion alone
// would have brought to `carried`, towards the place where its sector has it.
PALPA_FN Gliding glide(Float3 carried, Float3 speed, Float3 target, float frame_s) {
  Gliding r;
  r.place = carried;
  r.speed = speed;
  const Float3 way = minus(target, carried);
  if (!(frame_s > 0.0f)) {
    if (dot3(way, way) > product(astray_m, astray_m)) r.place = target;
    return r;
  }
  PALPA_EXACT float rate = 1.0f / frame_s;
  r.speed = moved(speed, minus(scaled(way, rate), speed), low_pass(speed_hz, frame_s));
  PALPA_EXACT float cutoff = cutoff_hz + cutoff_per_m * sqrt(dot3(r.speed, r.speed));
  PALPA_EXACT float share = low_pass(cutoff, frame_s);
  PALPA_EXACT float wanted = share * sqrt(dot3(way, way));
  PALPA_EXACT float most = most_glide_mps * frame_s;
  if (wanted > most) {
    PALPA_EXACT float shorter = share * (most / wanted);
    r.place = moved(carried, way, shorter);
  } else {
    r.place = moved(carried, way, share);
  }
  return r;
}

PALPA_SHADER_END
#endif
