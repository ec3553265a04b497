#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/touch/fingers/fingers.h"
#include "shaders/touch/follow/glide.h"
#include "shaders/touch/follow/glide_math.h"

// Foci that do not jump, for one finger per group: each focus is moved along with the finger and goes on from there
// towards the place where its sector has it. The rules are in docs/touch.md.
layout(local_size_x = 64) in;

layout(std430, set = 0, binding = 0) buffer Fingers { FingerRecord fingers[]; };
layout(std430, set = 0, binding = 1) readonly buffer Tracks { TrackTable table; };
layout(std430, set = 0, binding = 2) buffer Foci { FocusRecord foci[]; };
layout(std430, set = 0, binding = 3) buffer Homes { Home homes[]; };

shared FocusRecord sector[foci_most];
shared uint held[2];

Float3 xyz(vec4 v) {
  return Float3(v.x, v.y, v.z);
}

Axes frame_of(vec4 axis1, vec4 axis3) {
  return Axes(xyz(axis1), cross3(xyz(axis3), xyz(axis1)), xyz(axis3), 0.0, 0.0, 0.0);
}

// The nearest sector by angle that has contacts; of two equally near sectors, the one with the lower index.
uint nearest_filled(uint n, uint count) {
  for (uint apart = 0u; apart <= count / 2u; ++apart) {
    const uint before = (n + count - apart) % count;
    const uint after = (n + apart) % count;
    const uint low = min(before, after);
    if (sector[low].points != 0u) return low;
    const uint high = max(before, after);
    if (sector[high].points != 0u) return high;
  }
  return n;
}

void main() {
  const uint n = gl_LocalInvocationIndex;
  const uint finger = gl_WorkGroupID.x;
  const uint count = min(fingers[finger].foci, foci_most);
  const uint home = table.tracks[finger].home;
  const uint since_us = table.tracks[finger].since_us;
  const bool restart = since_us == follow_restart || homes[home].foci != count;
  const vec4 axis1 = fingers[finger].axis1, axis3 = fingers[finger].axis3, centre = fingers[finger].centre;
  const Float3 old_centre = xyz(homes[home].centre);
  const Float3 velocity = xyz(homes[home].velocity);
  const Axes old_axes = frame_of(homes[home].axis1, homes[home].axis3);
  if (n < count) sector[n] = foci[finger * foci_most + n];
  if (n < 2u) held[n] = 0u;
  barrier();

  if (n < count) {
    GlidingFocus focus = homes[home].focus[n];
    const bool empty = sector[n].points == 0u;
    const FocusRecord there = sector[nearest_filled(n, count)];
    Float3 target = Float3(there.x, there.y, there.z);
    Gliding now;
    now.place = target;
    now.speed = Float3(0.0, 0.0, 0.0);
    if (restart) {
      focus.empty_us = empty ? hold_us + 1u : 0u;
    } else {
      const float frame_s = in_seconds(since_us);
      const Float3 motion = motion_of(old_centre, xyz(centre), velocity, frame_s);
      const Float3 offset = minus(Float3(focus.x, focus.y, focus.z), old_centre);
      const Float3 carried = moved(moved(old_centre, motion, 1.0), turned_along(offset, old_axes, frame_of(axis1, axis3)), 1.0);
      focus.empty_us = empty ? later(focus.empty_us, since_us) : 0u;
      if (empty && focus.empty_us <= hold_us) target = carried;
      now = glide(carried, Float3(focus.speed_x, focus.speed_y, focus.speed_z), target, frame_s);
    }
    if (empty && focus.empty_us <= hold_us) atomicOr(held[n / 32u], 1u << n % 32u);
    homes[home].focus[n] = GlidingFocus(now.place.x, now.place.y, now.place.z, focus.empty_us, now.speed.x, now.speed.y, now.speed.z, 0u);
    foci[finger * foci_most + n] = FocusRecord(now.place.x, now.place.y, now.place.z, sector[n].points);
  }
  barrier();
  if (n == 0u) {
    fingers[finger].placed = 1u;
    fingers[finger].held_low = held[0];
    fingers[finger].held_high = held[1];
    homes[home].centre = centre;
    homes[home].velocity = table.tracks[finger].velocity;
    homes[home].axis1 = axis1;
    homes[home].axis3 = axis3;
    homes[home].foci = count;
  }
}
