#version 460
#extension GL_GOOGLE_include_directive : require
#include "bridge_math.h"
#include "contacts.h"
#include "fingers.h"
#include "scan.h"

// One finger per group: some of its contacts, picked by a hash of their numbers, with the skin's normal there as the depth
// picture shows it.
layout(local_size_x = 64) in;

layout(std430, set = 0, binding = bridge_sample_total) readonly buffer Total { ScanTotal found; };
layout(std430, set = 0, binding = bridge_sample_parents) readonly buffer Parents { uint parents[]; };
layout(std430, set = 0, binding = bridge_sample_contacts) readonly buffer Contacts { ContactRecord contacts[]; };
layout(std430, set = 0, binding = bridge_sample_header) readonly buffer Header { TouchHeader header; };
layout(std430, set = 0, binding = bridge_sample_fingers) readonly buffer Fingers { FingerRecord fingers[]; };
layout(std430, set = 0, binding = bridge_sample_depth) readonly buffer Depth { uint depth[]; };
layout(std430, set = 0, binding = bridge_sample_rays) readonly buffer Rays { vec2 rays[]; };
layout(std430, set = 0, binding = bridge_sample_cameras) readonly buffer Cameras { BridgeCamera cameras[]; };
layout(std430, set = 0, binding = bridge_sample_out) writeonly buffer Samples { BridgeSample samples[]; };
layout(std430, set = 0, binding = bridge_sample_patches) writeonly buffer Patches { BridgePatch patches[]; };
layout(push_constant) uniform Push { BridgePush push; };

shared uint least[bridge_samples];
shared uint places[bridge_samples];
shared uint count_taken;
shared Float3 positions[bridge_samples];

Float3 point_of(BridgeCamera camera, uint u, uint v) {
  const uint pixel = camera.first_pixel + v * camera.pitch + u;
  const uint raw = depth[pixel >> 1u] >> ((pixel & 1u) * 16u) & 0xffffu;
  const vec2 ray = rays[pixel];
  return pixel_point(camera, raw, Float2(ray.x, ray.y));
}

Float3 normal_at(uint point) {
  uint c = 0u;
  for (uint i = 1u; i < push.cameras; ++i) c = point >= cameras[i].first_index ? i : c;
  const BridgeCamera camera = cameras[c];
  const uint v = (point - camera.first_index) / camera.width;
  const uint u = (point - camera.first_index) - v * camera.width;
  const Float3 nothing = Float3(0.0, 0.0, 0.0);
  const uint far = bridge_normal_pixels;
  const Float3 at = point_of(camera, u, v);
  Float3 left = nothing, right = nothing, above = nothing, below = nothing;
  if (u >= far) left = point_of(camera, u - far, v);
  if (u + far < camera.width) right = point_of(camera, u + far, v);
  if (v >= far) above = point_of(camera, u, v - far);
  if (v + far < camera.height) below = point_of(camera, u, v + far);
  return skin_normal(camera, at, left, right, above, below);
}

void main() {
  if (header.fingers < 2u) return;
  const uint thread = gl_LocalInvocationIndex;
  const uint finger = gl_WorkGroupID.x;
  const uint count = min(found.total, push.most_contacts);
  const uint root = parents[fingers[finger].first];
  least[thread] = 0xffffffffu;
  barrier();
  for (uint i = thread; i < count; i += bridge_group) {
    if (parents[i] != root) continue;
    const uint hash = i * bridge_hash;
    atomicMin(least[hash >> bridge_sample_shift], hash);
  }
  barrier();
  bool taken = least[thread] != 0xffffffffu;
  Float3 position = Float3(0.0, 0.0, 0.0);
  Float3 normal = position;
  if (taken) {
    const uint i = least[thread] * bridge_unhash;
    position = Float3(contacts[i].x, contacts[i].y, contacts[i].z);
    normal = normal_at(contacts[i].point);
    taken = dot3(normal, normal) > 0.0;
  }
  places[thread] = taken ? 1u : 0u;
  barrier();
  // Close up, in the order of the hash.
  if (thread == 0u) {
    uint place = 0u;
    for (uint s = 0u; s < bridge_samples; ++s) {
      const uint one = places[s];
      places[s] = place;
      place += one;
    }
    count_taken = place;
  }
  barrier();
  if (taken) {
    positions[places[thread]] = position;
    samples[finger * bridge_samples + places[thread]] =
        BridgeSample(position.x, position.y, position.z, normal.x, normal.y, normal.z, 0u, 0u);
  }
  barrier();
  if (thread == 0u && count_taken == 0u) patches[finger] = BridgePatch(vec4(0.0), vec4(0.0), vec4(0.0), 0u, 0u, 0u, 0u);
  if (thread == 0u && count_taken != 0u) {
    Float3 low = positions[0], high = low, sum = Float3(0.0, 0.0, 0.0);
    for (uint s = 0u; s < count_taken; ++s) {
      const Float3 p = positions[s];
      low = Float3(min(low.x, p.x), min(low.y, p.y), min(low.z, p.z));
      high = Float3(max(high.x, p.x), max(high.y, p.y), max(high.z, p.z));
      sum = plus(sum, minus(p, positions[0]));
    }
    const Float3 mean = plus(positions[0], scaled(sum, 1.0 / float(count_taken)));
    patches[finger] = BridgePatch(vec4(low.x, low.y, low.z, 0.0), vec4(high.x, high.y, high.z, 0.0),
                                  vec4(mean.x, mean.y, mean.z, 0.0), count_taken, 0u, 0u, 0u);
  }
}
