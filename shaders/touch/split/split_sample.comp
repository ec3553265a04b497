#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/touch/contacts/contacts.h"
#include "shaders/touch/fingers/fingers.h"
#include "shaders/shared/scan.h"
#include "shaders/touch/split/split_math.h"
#include "shaders/touch/known/known_math.h"

// One finger per group: samples of its skin, whether a surface supports it, and whether it is wider than a finger.
layout(local_size_x = 64) in;

layout(std430, set = 0, binding = 0) readonly buffer Total { ScanTotal found; };
layout(std430, set = 0, binding = 1) readonly buffer Parents { uint parents[]; };
layout(std430, set = 0, binding = 2) readonly buffer Contacts { ContactRecord contacts[]; };
layout(std430, set = 0, binding = 3) readonly buffer Fingers { FingerRecord fingers[]; };
layout(std430, set = 0, binding = 4) readonly buffer Depth { uint depth[]; };
layout(std430, set = 0, binding = 5) readonly buffer Rays { vec2 rays[]; };
layout(std430, set = 0, binding = 6) readonly buffer Cameras { BridgeCamera cameras[]; };
layout(std430, set = 0, binding = 7) writeonly buffer Samples { BridgeSample samples[]; };
layout(std430, set = 0, binding = 8) writeonly buffer States { SplitState states[]; };
layout(std430, set = 0, binding = 9) buffer Header { TouchHeader header; };
layout(std430, set = 0, binding = 10) writeonly buffer Shown { uvec4 evidence[]; };  // SplitEvidence[]
layout(std430, set = 0, binding = 11) readonly buffer Known { KnownTable known; };
layout(push_constant) uniform Push { SplitPush push; };

#include "shaders/touch/bridge/bridge_pick.glsl"
#include "shaders/touch/known/known_label.glsl"

shared uint wide;
shared uint least_label;
shared uint most_label;
shared uint seen;
shared uint firm;

bool is_firm(uint point) {
  const SeenPixel p = pixel_of(point);
  const BridgeCamera camera = cameras[p.camera];
  const float at = product(float(raw_at(camera, p.u, p.v)), camera.depth_unit);
  uint near = 0u;
  for (uint k = 0u; k < split_window * split_window; ++k) {
    const uint u = p.u + k % split_window, v = p.v + k / split_window;  // both too large by split_reach
    if (u < split_reach || v < split_reach || u - split_reach >= camera.width || v - split_reach >= camera.height) continue;
    const uint raw = raw_at(camera, u - split_reach, v - split_reach);
    if (raw >= camera.first_depth && is_near(at, product(float(raw), camera.depth_unit))) ++near;
  }
  return near >= split_company;
}

void main() {
  const uint thread = gl_LocalInvocationIndex;
  const uint finger = gl_WorkGroupID.x;
  const uint root = parents[fingers[finger].first];
  if (thread == 0u) {
    wide = seen = firm = most_label = 0u;
    least_label = known_none;
  }
  pick_samples(root, min(found.total, push.most_contacts));
  if (least[thread] != 0xffffffffu) {
    atomicAdd(seen, 1u);
    if (is_firm(contacts[least[thread] * bridge_unhash].point)) atomicAdd(firm, 1u);
  }
  uint label = known_none;
  if (thread < count_taken) {
    const Float3 position = positions[thread];
    const Float3 normal = normals[thread];
    label = known_label(fingers[finger].solid, position, normal);
    samples[finger * bridge_samples + thread] =
        BridgeSample(position.x, position.y, position.z, normal.x, normal.y, normal.z,
                     (push.rules & known_apart) != 0u ? label : known_none, 0u);
    if (label != known_none && (push.rules & known_apart) != 0u) {
      atomicMin(least_label, label);
      atomicMax(most_label, label);
    }
  }
  const uint majority = known_majority(label, count_taken);  // its barriers also end the writes above
  const bool held = (push.rules & known_apart) != 0u && majority != known_none;
  const float widest = product(held ? PALPA_SPLIT_KNOWN_WIDE : 1.0, push.finger_width);
  if (thread < count_taken && widest > 0.0) {
    for (uint s = 0u; s < count_taken; ++s) {
      if (square_apart(positions[thread], positions[s]) > product(widest, widest)) wide = 1u;
    }
  }
  barrier();
  const bool several = push.finger_width > 0.0 && least_label < most_label;
  const bool look_again = wide != 0u || several;
  if (look_again) evidence[finger * bridge_samples + thread] = uvec4(0u);
  if (thread == 0u) {
    const bool is_known = (push.rules & known_few) != 0u && majority != known_none;
    const uint kind = !supported(seen, firm, is_known) ? split_ghost : look_again ? split_wide : split_stays;
    states[finger] = SplitState(kind, count_taken, 0u, 0u, root, 0u, 0u, 0u);
    if (kind == split_wide) {
      atomicMax(header.look_x, finger + 1u);
      atomicMax(header.parts_x, finger + 1u);
      atomicMax(header.assign_x, found.groups_x);
    }
    if (kind != split_stays) atomicMax(header.list_x, 1u);
  }
}
