#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/touch/bridge/bridge_math.h"
#include "shaders/touch/contacts/contacts.h"
#include "shaders/touch/fingers/fingers.h"
#include "shaders/touch/known/known_math.h"

// Every pair of patches: one group per patch, which goes through the later patches.
layout(local_size_x = 64) in;

layout(std430, set = 0, binding = 0) readonly buffer Header { TouchHeader header; };
layout(std430, set = 0, binding = 1) readonly buffer Fingers { FingerRecord fingers[]; };
layout(std430, set = 0, binding = 2) readonly buffer Depth { uint depth[]; };
layout(std430, set = 0, binding = 3) readonly buffer Cameras { BridgeCamera cameras[]; };
layout(std430, set = 0, binding = 4) readonly buffer Samples { BridgeSample samples[]; };
layout(std430, set = 0, binding = 5) readonly buffer Patches { BridgePatch patches[]; };
layout(std430, set = 0, binding = 6) writeonly buffer Pairs { BridgePair pairs[]; };
layout(std430, set = 0, binding = 7) coherent buffer Known { KnownTable known; };
layout(push_constant) uniform Push { BridgePush push; };

#include "shaders/sensing/raw_depth.glsl"

// For each sample of either patch: how near the other patch is, and the cosines at both ends of the way to it.
shared float apart[2u * bridge_samples];
shared float leaving_a[2u * bridge_samples];
shared float leaving_b[2u * bridge_samples];
shared float along[2u * bridge_samples];  // place on the line from mean to mean
shared uint empty_places[bridge_samples];

Float3 position(uint s) { return Float3(samples[s].x, samples[s].y, samples[s].z); }
Float3 normal(uint s) { return Float3(samples[s].normal_x, samples[s].normal_y, samples[s].normal_z); }

// Sample `s` against all of the other patch. Returns the cosines at both ends, its own first.
Float2 look_across(uint slot, uint s, uint first, uint count) {
  const Float3 here = position(s);
  float nearest = 3.0e38;
  uint there = first;
  for (uint k = first; k < first + count; ++k) {
    const float square = square_apart(here, position(k));
    if (square < nearest) {
      nearest = square;
      there = k;
    }
  }
  apart[slot] = sqrt(nearest);
  return Float2(leaving(here, normal(s), position(there)), leaving(position(there), normal(there), here));
}

bool is_seen_empty(Float3 place) {
  bool empty = false;
  for (uint c = 0u; c < push.cameras; ++c) {
    const BridgeCamera camera = cameras[c];
    const Appearance seen = appearance(camera, place);
    if (seen.depth > 0.0) empty = empty || sees_through(camera, raw_at(camera, seen.u, seen.v), seen.depth);
  }
  return empty;
}

bool sampled(uint slot, uint samples_a, uint samples_b) {
  return slot < bridge_samples ? slot < samples_a : slot - bridge_samples < samples_b;
}

shared BridgePair result;

void main() {
  const uint thread = gl_LocalInvocationIndex;
  const uint a = gl_WorkGroupID.x;
  const BridgePatch one = patches[a];
  const uint first_a = a * bridge_samples;
  for (uint b = a + 1u; b < header.fingers; ++b) {
    const BridgePatch other = patches[b];
    const uint first_b = b * bridge_samples;
    const Float3 line = minus(Float3(other.mean.x, other.mean.y, other.mean.z), Float3(one.mean.x, one.mean.y, one.mean.z));
    // Patches of a known finger stay one more easily, until it has looked like several fingers before.
    const bool same = one.known != known_none && one.known == other.known;
    bool were_one = same;
    if (same) were_one = !may_part(known.fingers[one.known], push.elapsed_us);
    const float width = were_one ? product(PALPA_BRIDGE_STILL_ONE, push.finger_width) : push.finger_width;
    barrier();  // all have read the pair before
    if (thread == 0u) {
      const bool near = fingers[a].solid == fingers[b].solid && near_enough(one, other, width);
      result = BridgePair(near ? bridge_unknown : bridge_two, 0.0);
    }
    barrier();

    if (result.kind != bridge_two) {  // here and below: the same for the whole group
      if (thread < one.samples) along[thread] = dot3(position(first_a + thread), line);
      if (thread < other.samples) along[bridge_samples + thread] = dot3(position(first_b + thread), line);
      barrier();
      if (thread == 0u) {
        float low = 3.0e38;
        float high = -3.0e38;
        for (uint s = 0u; s < 2u * bridge_samples; ++s) {
          if (!sampled(s, one.samples, other.samples)) continue;
          low = along[s] < low ? along[s] : low;
          high = along[s] > high ? along[s] : high;
        }
        if (too_wide(low, high, dot3(line, line), width)) result.kind = bridge_two;
      }
      barrier();
    }

    if (result.kind != bridge_two) {
      if (thread < one.samples) {
        const Float2 ends = look_across(thread, first_a + thread, first_b, other.samples);
        leaving_a[thread] = ends.x;
        leaving_b[thread] = ends.y;
      }
      if (thread < other.samples) {
        const Float2 ends = look_across(bridge_samples + thread, first_b + thread, first_a, one.samples);
        leaving_b[bridge_samples + thread] = ends.x;
        leaving_a[bridge_samples + thread] = ends.y;
      }
      barrier();
      if (thread == 0u) {
        Evidence e = no_evidence();
        for (uint s = 0u; s < 2u * bridge_samples; ++s) {
          if (sampled(s, one.samples, other.samples)) e = with_length(e, apart[s]);
        }
        for (uint s = 0u; s < 2u * bridge_samples; ++s) {
          if (sampled(s, one.samples, other.samples)) e = with_way(e, apart[s], leaving_a[s], leaving_b[s]);
        }
        result = facing_verdict(e, were_one);
      }
      barrier();
    }

    if (result.kind != bridge_two) {
      uint empty = 0u;
      if (thread < one.samples) {
        const Float3 from = position(first_a + thread);
        const Float3 to = position(first_b + chord_end(thread, other.samples));
        for (uint k = bridge_first_step; k <= bridge_last_step; ++k) {
          empty += is_seen_empty(between(from, to, chord_share(k))) ? 1u : 0u;
        }
      }
      empty_places[thread] = empty;
      barrier();
      if (thread == 0u) {
        uint sum = 0u;
        for (uint s = 0u; s < bridge_samples; ++s) sum += empty_places[s];
        if (too_empty(sum, one.samples * (bridge_last_step - bridge_first_step + 1u), were_one)) result = BridgePair(bridge_two, 0.0);
      }
    }
    if (thread == 0u) {
      if (same && result.kind != bridge_one) {
        atomicOr(known.doubts[one.known], doubt_one);
        if (were_one && one.samples > 0u && other.samples > 0u) result = BridgePair(bridge_one, PALPA_BRIDGE_HELD);
      }
      pairs[a * bridge_fingers + b] = result;
    }
  }
}
