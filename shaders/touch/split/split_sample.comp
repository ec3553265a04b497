#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/touch/contacts/contacts.h"
#include "shaders/touch/fingers/fingers.h"
#include "shaders/shared/scan.h"
#include "shaders/touch/split/split_math.h"

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
layout(push_constant) uniform Push { SplitPush push; };

#include "shaders/touch/bridge/bridge_pick.glsl"

shared uint wide;
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
  if (thread == 0u) wide = seen = firm = 0u;
  pick_samples(root, min(found.total, push.most_contacts));
  if (least[thread] != 0xffffffffu) {
    atomicAdd(seen, 1u);
    if (is_firm(contacts[least[thread] * bridge_unhash].point)) atomicAdd(firm, 1u);
  }
  if (thread < count_taken) {
    const Float3 position = positions[thread];
    const Float3 normal = normals[thread];
    samples[finger * bridge_samples + thread] =
        BridgeSample(position.x, position.y, position.z, normal.x, normal.y, normal.z, 0u, 0u);
    for (uint s = 0u; s < count_taken; ++s) {
      if (push.finger_width > 0.0 && square_apart(position, positions[s]) > product(push.finger_width, push.finger_width)) wide = 1u;
    }
  }
  barrier();
  if (wide != 0u) evidence[finger * bridge_samples + thread] = uvec4(0u);
  if (thread == 0u) {
    const uint kind = !supported(seen, firm) ? split_ghost : wide != 0u ? split_wide : split_stays;
    states[finger] = SplitState(kind, count_taken, 0u, 0u, root, 0u, 0u, 0u);
    if (kind == split_wide) {
      atomicMax(header.look_x, finger + 1u);
      atomicMax(header.parts_x, finger + 1u);
      atomicMax(header.assign_x, found.groups_x);
    }
    if (kind != split_stays) atomicMax(header.list_x, 1u);
  }
}
