#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/touch/fingers/fingers.h"
#include "shaders/touch/split/split_math.h"
#include "shaders/touch/known/known_math.h"

// Writes the list of fingers again, in the order of their smallest contacts: with parts in place of fingers that were
// split, without fingers that no surface supports. A single group, one finger per thread.
layout(local_size_x = 64) in;

layout(std430, set = 0, binding = 0) buffer Header { TouchHeader header; };
layout(std430, set = 0, binding = 1) buffer Fingers { FingerRecord fingers[]; };
layout(std430, set = 0, binding = 2) readonly buffer States { SplitState states[]; };
layout(std430, set = 0, binding = 3) readonly buffer Clusters { Cluster clusters[]; };
layout(push_constant) uniform Push { SplitPush push; };

shared uint kinds[bridge_fingers];
shared uint firsts[bridge_fingers];
shared uvec2 parts[bridge_fingers];  // those that are fingers
shared uint changed;

bool holds(uvec2 set, uint part) {
  return ((part < 32u ? set.x : set.y) >> part % 32u & 1u) != 0u;
}
uint first_of(uvec2 set) {
  return set.x != 0u ? uint(findLSB(set.x)) : 32u + uint(findLSB(set.y));
}
uvec2 without_first(uvec2 set) {
  return set.x != 0u ? uvec2(set.x & (set.x - 1u), set.y) : uvec2(0u, set.y & (set.y - 1u));
}
Cluster part_of(uint finger, uint part) {
  return clusters[push.most_contacts + finger * split_numbers + part];
}

// The number of fingers that begin before a contact of one of the `count` fingers, at most fingers_most. (A software
// device ends all loops of a shader after 65,535 iterations together, so only existing parts are walked.)
uint rank_of(uint contact, uint count) {
  uint rank = 0u;
  for (uint f = 0u; f < count && firsts[f] < contact && rank < fingers_most; ++f) {
    if (kinds[f] == split_several) {
      for (uvec2 left = parts[f]; left != uvec2(0u); left = without_first(left)) {
        if (part_of(f, first_of(left)).smallest < contact) ++rank;
      }
    } else if (kinds[f] != split_ghost) {
      ++rank;
    }
  }
  return rank;
}

void main() {
  const uint thread = gl_LocalInvocationIndex;
  const uint count = min(header.fingers, bridge_fingers);
  if (thread == 0u) changed = 0u;
  barrier();
  FingerRecord record;
  if (thread < count) {
    record = fingers[thread];
    const SplitState state = states[thread];
    kinds[thread] = state.kind;
    firsts[thread] = record.first;
    uvec2 set = uvec2(0u);
    if (state.kind == split_several) {
      const uvec2 all = uvec2(state.parts_low, state.parts_high);
      const uvec2 known = (push.rules & known_few) != 0u ? uvec2(state.known_low, state.known_high) : uvec2(0u);
      for (uint p = 0u; p < split_numbers; ++p) {
        if (holds(all, p) && part_of(thread, p).size >= least_contacts(push.min_points, holds(known, p))) set |= p < 32u ? uvec2(1u << p, 0u) : uvec2(0u, 1u << (p - 32u));
      }
    }
    parts[thread] = set;
    if (state.kind == split_several || state.kind == split_ghost) changed = 1u;
  }
  barrier();
  if (changed == 0u) return;  // the whole group

  if (thread < count && kinds[thread] == split_several) {
    for (uvec2 left = parts[thread]; left != uvec2(0u); left = without_first(left)) {
      const Cluster part = part_of(thread, first_of(left));
      const uint rank = rank_of(part.smallest, count);
      if (rank >= fingers_most) continue;
      fingers[rank].first = part.smallest;
      fingers[rank].solid = record.solid;
      fingers[rank].contacts = part.size;
    }
  } else if (thread < count && kinds[thread] != split_ghost) {
    const uint rank = rank_of(record.first, count);
    if (rank < fingers_most) {
      fingers[rank].first = record.first;
      fingers[rank].solid = record.solid;
      fingers[rank].contacts = record.contacts;
    }
  }
  if (thread == 0u) {
    uint total = 0u;
    for (uint f = 0u; f < count; ++f) {
      total += kinds[f] == split_several ? uint(bitCount(parts[f].x) + bitCount(parts[f].y)) : kinds[f] == split_ghost ? 0u : 1u;
    }
    header.clusters = header.clusters - count + total;
    header.fingers = min(total, fingers_most);
    header.patches_x = total > 1u ? header.fingers : 0u;
    header.join_x = total > 1u ? 1u : 0u;
  }
}
