// The arithmetic of known fingers, the same in shaders and twins: see exact_math.h. The rules are in docs/touch.md.
#ifndef PALPA_SHADERS_KNOWN_MATH_H
#define PALPA_SHADERS_KNOWN_MATH_H
#include "shaders/shared/exact_math.h"
#include "shaders/touch/contacts/known.h"
PALPA_SHADER_BEGIN

// Skin belongs to a known finger if its inside is within this share of the greatest width of a finger.
#define PALPA_KNOWN_REACH 0.4f
// An island is not born until it has been there for this time. It is the same island if it begins within this distance.
PALPA_CONST island_wait_us = 50000u;
#define PALPA_ISLAND_REACH 8e-3f

PALPA_FN float known_seconds(uint us) {
  PALPA_EXACT float s = float(us) * 1.0e-6f;
  return s;
}

// Where a point was in the frame before, if it has moved with a finger.
PALPA_FN Float3 moved_back(Float3 place, vec4 velocity, float elapsed_s) {
  PALPA_EXACT Float3 r;
  r.x = place.x - velocity.x * elapsed_s;
  r.y = place.y - velocity.y * elapsed_s;
  r.z = place.z - velocity.z * elapsed_s;
  return r;
}

// A known finger with fewer contacts in the shell than this times the least number is about to end. One without any has
// ended. Skin around its samples up to the first distance, and beyond the shell's edges up to the second one, may be
// its contacts.
PALPA_CONST known_starving = 8u;
#define PALPA_KNOWN_AROUND 3e-3f
#define PALPA_KNOWN_EDGE 0.5e-3f

PALPA_FN bool starves(uint contacts, uint min_points) {
  return contacts > 0u && contacts < known_starving * (min_points > 1u ? min_points : 1u);
}

PALPA_FN float squared_reach(float farthest) {
  const float reach = plus(farthest, PALPA_KNOWN_AROUND);
  return product(reach, reach);
}

// The place by which skin is tested again: deeper by the reach beyond an edge, or as much shallower.
PALPA_FN Float3 shifted(Float3 place, vec4 inward, bool deeper) {
  const float shift = deeper ? PALPA_KNOWN_EDGE : -PALPA_KNOWN_EDGE;
  PALPA_EXACT Float3 r;
  r.x = place.x + inward.x * shift;
  r.y = place.y + inward.y * shift;
  r.z = place.z + inward.z * shift;
  return r;
}

PALPA_FN bool in_known_reach(Float3 place, KnownFinger finger, float elapsed_s) {
  if (!(finger.centre.w > 0.0f)) return false;
  const Float3 before = moved_back(place, finger.velocity, elapsed_s);
  PALPA_EXACT float x = before.x - finger.centre.x;
  PALPA_EXACT float y = before.y - finger.centre.y;
  PALPA_EXACT float z = before.z - finger.centre.z;
  PALPA_EXACT float square = x * x + y * y + z * z;
  return square <= finger.centre.w;
}

PALPA_FN uint older(uint age_us, uint elapsed_us) {
  return age_us > 0xffffffffu - elapsed_us ? 0xffffffffu : age_us + elapsed_us;
}

// A known finger parts if it looks like several fingers in two frames that are no farther apart than the first time. It
// is one with another finger once it has looked like that, in every frame, for the second time.
PALPA_CONST parting_us_most = 100000u;
PALPA_CONST meeting_us_least = 50000u;

PALPA_FN bool may_part(KnownFinger finger, uint elapsed_us) {
  return older(finger.parting_us, elapsed_us) <= parting_us_most;
}
PALPA_FN bool may_meet(KnownFinger finger, uint elapsed_us) {
  return older(finger.meeting_us, elapsed_us) >= meeting_us_least;
}

PALPA_FN uint next_parting_us(KnownFinger finger, uint doubts, uint elapsed_us) {
  return (doubts & doubt_one) != 0u ? 0u : older(finger.parting_us, elapsed_us);
}
PALPA_FN uint next_meeting_us(KnownFinger finger, uint doubts, uint elapsed_us) {
  return (doubts & doubt_apart) != 0u ? older(finger.meeting_us, elapsed_us) : 0u;
}

PALPA_FN bool same_island(Island a, Island b) {
  PALPA_EXACT float x = a.x - b.x;
  PALPA_EXACT float y = a.y - b.y;
  PALPA_EXACT float z = a.z - b.z;
  PALPA_EXACT float square = x * x + y * y + z * z;
  return square <= product(PALPA_ISLAND_REACH, PALPA_ISLAND_REACH);
}

// A finger that leaves has fewer contacts in each frame, while those of a finger at rest go up and down. A finger falls
// if it has lost at least an eighth of its contacts in two frames in a row, and no more than a quarter is left of those
// with which it began. It falls until it has more than this quarter again.
PALPA_FN Fall next_fall(Fall before, uint contacts) {
  Fall now;
  now.contacts = contacts;
  now.from = before.from;
  now.falls = before.from > 0u && 4u * contacts <= before.from ? 1u : 0u;
  if (before.falls != 0u && now.falls != 0u) return now;
  const bool loses = 8u * contacts <= 7u * before.contacts;
  if (!loses) now.falls = 0u;
  now.from = !loses ? 0u : before.from > 0u ? before.from : before.contacts;
  return now;
}

// The number of contacts that a finger needs.
PALPA_FN uint least_contacts(uint min_points, bool known) {
  const uint least = min_points > 1u ? min_points : 1u;
  return known ? (least + 1u) / 2u : least;
}

// Whether `contacts` are few beside a known finger's. A cluster with normals that belongs to that finger (`same`)
// may be a second finger that parts from it. Any other comes out of nothing, as ghosts do.
PALPA_FN bool small_beside(uint contacts, uint known_contacts, bool same) {
  return contacts < known_contacts / (same ? 4u : 2u);
}

// Whether a cluster that is no known finger has so few contacts that noise can begin and end it.
PALPA_FN bool small_alone(uint contacts, uint min_points) {
  return contacts < 2u * least_contacts(min_points, false);
}

PALPA_SHADER_END
#endif
