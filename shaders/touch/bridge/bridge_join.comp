#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/touch/bridge/bridge.h"
#include "shaders/touch/contacts/contacts.h"
#include "shaders/touch/fingers/fingers.h"
#include "shaders/shared/scan.h"

// Joins patches, the most certain pair first, unless a member of one and a member of the other are two fingers. Then it
// closes up the list of fingers, which stay in the order of their smallest contacts. A single group, one patch per
// thread.
layout(local_size_x = 64) in;

layout(std430, set = 0, binding = 0) readonly buffer Total { ScanTotal found; };
layout(std430, set = 0, binding = 1) readonly buffer Parents { uint parents[]; };
layout(std430, set = 0, binding = 2) readonly buffer Pairs { BridgePair pairs[]; };
layout(std430, set = 0, binding = 3) buffer Header { TouchHeader header; };
layout(std430, set = 0, binding = 4) buffer Fingers { FingerRecord fingers[]; };
layout(std430, set = 0, binding = 5) buffer Clusters { Cluster clusters[]; };
layout(push_constant) uniform Push { BridgePush push; };

// Sets of patches, as 64 bits. For each patch: the first patch of the finger that it is in.
shared uint head[bridge_fingers];
shared uvec2 members[bridge_fingers];
shared uvec2 strangers[bridge_fingers];
shared uint best[bridge_fingers];  // for each patch, the later one that it is most certainly one with, or
                                   // fingers_nothing
shared float sure[bridge_fingers];
shared uint sizes[bridge_fingers];
shared uint joined;

uvec2 only(uint patch_number) {
  return patch_number < 32u ? uvec2(1u << patch_number, 0u) : uvec2(0u, 1u << (patch_number - 32u));
}
bool holds(uvec2 set, uint patch_number) { return (set & only(patch_number)) != uvec2(0u); }

void main() {
  const uint thread = gl_LocalInvocationIndex;
  const uint count = min(header.fingers, bridge_fingers);
  head[thread] = thread;
  members[thread] = only(thread);
  uvec2 apart = uvec2(0u);
  for (uint b = 0u; b < count; ++b) {
    if (thread >= count || b == thread) continue;
    if (pairs[min(thread, b) * bridge_fingers + max(thread, b)].kind == bridge_two) apart |= only(b);
  }
  strangers[thread] = apart;
  if (thread == 0u) joined = 0u;
  barrier();

  for (uint round = 1u; round < count; ++round) {
    uint found_best = fingers_nothing;
    float found_sure = 0.0;
    for (uint b = thread + 1u; b < count; ++b) {
      const BridgePair pair = pairs[thread * bridge_fingers + b];
      if (pair.kind != bridge_one || head[thread] == head[b]) continue;
      if ((strangers[head[thread]] & members[head[b]]) != uvec2(0u)) continue;
      if (found_best == fingers_nothing || pair.facing < found_sure) {
        found_best = b;
        found_sure = pair.facing;
      }
    }
    best[thread] = found_best;
    sure[thread] = found_sure;
    barrier();
    if (thread == 0u) {
      uint a = fingers_nothing;
      for (uint p = 0u; p < count; ++p) {
        if (best[p] != fingers_nothing && (a == fingers_nothing || sure[p] < sure[a])) a = p;
      }
      joined = a;
      if (a != fingers_nothing) {
        const uint keeps = min(head[a], head[best[a]]);
        const uint goes = max(head[a], head[best[a]]);
        members[keeps] |= members[goes];
        strangers[keeps] |= strangers[goes];
        for (uint p = 0u; p < count; ++p) head[p] = head[p] == goes ? keeps : head[p];
      }
    }
    barrier();
    if (joined == fingers_nothing) break;  // the whole group
  }

  uint size = 0u;
  FingerRecord record = fingers[0];
  uint root = 0u;
  if (thread < count) {
    record = fingers[thread];
    root = parents[record.first];
  }
  sizes[thread] = thread < count ? record.contacts : 0u;
  barrier();
  uint rank = 0u;
  uint total = 0u;
  for (uint p = 0u; p < count; ++p) {
    const bool leads = head[p] == p;
    total += leads ? 1u : 0u;
    rank += leads && p < thread ? 1u : 0u;
    size += head[p] == thread ? sizes[p] : 0u;
  }
  if (thread < count) clusters[root].smallest = fingers[head[thread]].first;
  barrier();
  if (thread < count && head[thread] == thread) {
    record.contacts = size;
    fingers[rank] = record;
  }
  if (thread == 0u) {
    header.clusters -= count - total;
    header.fingers = total;
    header.relabel_x = total < count ? found.groups_x : 0u;
  }
}
