#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/touch/contacts/contacts.h"
#include "shaders/touch/fingers/fingers.h"
#include "shaders/touch/known/known_math.h"

// Closes up the list of fingers without those that have too few contacts and those that are islands. A single group.
// Fingers are few, and each decision needs all claims, so one thread does the work.
layout(local_size_x = 64) in;

layout(std430, set = 0, binding = 0) buffer Header { TouchHeader header; };
layout(std430, set = 0, binding = 1) buffer Fingers { FingerRecord fingers[]; };
layout(std430, set = 0, binding = 2) readonly buffer Contacts { ContactRecord contacts[]; };
layout(std430, set = 0, binding = 3) buffer Claims { Claim claims[]; };
layout(std430, set = 0, binding = 4) buffer Known { KnownTable known; };
layout(push_constant) uniform Push { KnownPush push; };

shared uint heir[known_fingers];  // of each known finger: the largest finger that claims it
shared Island islands[known_fingers];

// The known finger beside which `f` is an island, or known_none.
uint beside(uint f) {
  const uint k = claims[f].known != known_none ? claims[f].known : claims[f].near;
  if (k == known_none || heir[k] == known_none || heir[k] == f) return known_none;
  const bool same = claims[f].known == k && claims[f].samples > 0u;
  return small_beside(claims[f].contacts, known.fingers[k].fall.contacts, same) ? k : known_none;
}

void main() {
  const uint thread = gl_LocalInvocationIndex;
  const bool restart = push.elapsed_us == known_restart;
  heir[thread] = known_none;
  barrier();
  if (thread != 0u) return;
  const uint count = min(header.fingers, known_fingers);
  for (uint f = 0u; f < count; ++f) {
    const uint k = claims[f].known;
    if (k != known_none && (heir[k] == known_none || claims[f].contacts > claims[heir[k]].contacts)) heir[k] = f;
  }
  const uint islands_before = restart ? 0u : min(known.islands, known_fingers);
  uint kept = 0u;
  uint islands_now = 0u;
  for (uint f = 0u; f < count; ++f) {
    const uint first = fingers[f].first;
    const uint solid = fingers[f].solid;
    const uint size = fingers[f].contacts;
    const uint claimed = claims[f].known;
    const bool goes_on = (push.rules & known_few) != 0u && claimed != known_none && next_fall(known.fingers[claimed].fall, size).falls == 0u;
    bool stays = size >= least_contacts(push.min_points, goes_on);
    const bool faint = claimed == known_none && small_alone(size, push.min_points);
    if (stays && !restart && (push.rules & known_islands) != 0u && (faint || beside(f) != known_none)) {
      Island island = Island(contacts[first].x, contacts[first].y, contacts[first].z, solid, 0u, 0u, 0u, 0u);
      for (uint k = 0u; k < islands_before; ++k) {
        if (known.island[k].solid == solid && same_island(island, known.island[k])) {
          island.age_us = max(island.age_us, older(known.island[k].age_us, push.elapsed_us));
        }
      }
      stays = island.age_us >= island_wait_us;
      if (!stays) islands[islands_now++] = island;
    }
    if (!stays) continue;
    fingers[kept].first = first;
    fingers[kept].solid = solid;
    fingers[kept].contacts = size;
    claims[kept].parting_us = known_never;
    claims[kept].meeting_us = 0u;
    claims[kept].fall = Fall(0u, 0u, 0u);
    if (claimed != known_none) {
      claims[kept].parting_us = next_parting_us(known.fingers[claimed], known.doubts[claimed], push.elapsed_us);
      claims[kept].meeting_us = next_meeting_us(known.fingers[claimed], known.doubts[claimed], push.elapsed_us);
      claims[kept].fall = known.fingers[claimed].fall;
    }
    ++kept;
  }
  header.clusters -= header.fingers - kept;
  header.fingers = kept;
  known.count = kept;  // known_keep fills them in
  known.reached = restart ? 0u : known.reaching;
  known.reaching = 0u;
  known.islands = islands_now;
  for (uint k = 0u; k < known_fingers; ++k) known.doubts[k] = 0u;
  for (uint k = 0u; k < islands_now; ++k) known.island[k] = islands[k];
}
