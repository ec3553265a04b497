#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/touch/contacts/contacts.h"
#include "shaders/touch/fingers/fingers.h"
#include "shaders/touch/split/split_math.h"

// The evidence of the depth pictures for every two samples of a finger that is too wide. For each camera, the ways
// between the samples that it sees are shared out among split_looks groups, which all number them alike. The results
// are sets, so their order does not matter.
layout(local_size_x = 64) in;

layout(std430, set = 0, binding = 0) readonly buffer Depth { uint depth[]; };
layout(std430, set = 0, binding = 1) readonly buffer Cameras { BridgeCamera cameras[]; };
layout(std430, set = 0, binding = 2) readonly buffer Samples { BridgeSample samples[]; };
layout(std430, set = 0, binding = 3) readonly buffer States { SplitState states[]; };
layout(std430, set = 0, binding = 4) buffer Shown { uint evidence[]; };  // SplitEvidence[]
layout(push_constant) uniform Push { SplitPush push; };

const uint most = bridge_samples;
const uint sum_threads = most, sum_row = 8u;
#include "shaders/shared/sum_before.glsl"
#include "shaders/sensing/raw_depth.glsl"

const uint words = 4u;  // of SplitEvidence; those of valleys follow the others

shared SplitView views[most];
shared uint seen[most];  // samples that the camera sees, in their order
shared uint seen_count;
shared uint found[most * words];

SplitWalk step_on(SplitWalk walk, BridgeCamera camera, SplitView a, SplitView b, uint s) {
  if (s > walk.steps || walk.state == split_valley) return walk;
  const uint raw = raw_at(camera, pixel_between(a.u, b.u, s, walk.steps), pixel_between(a.v, b.v, s, walk.steps));
  if (raw < camera.first_depth) return walked_hole(walk);
  return walked(walk, line_depth(a.at.z, b.at.z, s, walk.steps), product(float(raw), camera.depth_unit));
}

// A software device ends all loops of a shader after 65,535 iterations together, however many cameras there are. So an
// iteration is four steps here, and pairs are shared out evenly.
bool is_valley_between(BridgeCamera camera, SplitView a, SplitView b) {
  SplitWalk walk = walk_between(a, b);
  for (uint s = 0u; s <= walk.steps && walk.steps > 0u && walk.state != split_valley; s += 4u) {
    walk = step_on(walk, camera, a, b, s);
    walk = step_on(walk, camera, a, b, s + 1u);
    walk = step_on(walk, camera, a, b, s + 2u);
    walk = step_on(walk, camera, a, b, s + 3u);
  }
  return walk.state == split_valley;
}

// Adds `other` to the set of sample `s` that begins at `word`.
void put(uint s, uint word, uint other) {
  atomicOr(found[s * words + word + other / 32u], 1u << other % 32u);
}

void look(uint c, uint count) {
  const uint thread = gl_LocalInvocationIndex;
  const BridgeCamera camera = cameras[c];
  bool sees = false;
  if (thread < count) {
    const BridgeSample s = samples[gl_WorkGroupID.x * most + thread];
    const Float3 place = Float3(s.x, s.y, s.z);
    const Appearance a = appearance(camera, place);
    views[thread] = split_view(camera, a, raw_at(camera, a.u, a.v), place);
    sees = views[thread].seen;
  }
  const uint before = sum_before(sees ? 1u : 0u);
  if (sees) seen[before] = thread;
  if (thread == most - 1u) seen_count = before + (sees ? 1u : 0u);
  barrier();
  // Each sample with the half that follows it round the circle: this gives each pair once.
  const uint here = seen_count;
  const uint pairs = here * (here / 2u);
  for (uint p = gl_WorkGroupID.y * split_group + thread; p < pairs; p += split_looks * split_group) {
    const uint along = p / here + 1u, place = p - (along - 1u) * here;
    if (2u * along == here && place >= along) continue;
    const uint one = seen[place], other = seen[place + along < here ? place + along : place + along - here];
    const uint a = min(one, other), b = max(one, other);
    put(a, 0u, b);
    put(b, 0u, a);
    if (!is_valley_between(camera, views[a], views[b])) continue;
    put(a, 2u, b);
    put(b, 2u, a);
  }
  barrier();
}

void main() {
  const uint thread = gl_LocalInvocationIndex;
  const uint finger = gl_WorkGroupID.x;
  if (states[finger].kind != split_wide) return;  // the whole group
  const uint count = min(states[finger].samples, most);
  for (uint w = 0u; w < words; ++w) found[thread * words + w] = 0u;
  for (uint c = 0u; c < push.cameras; ++c) look(c, count);
  for (uint w = 0u; w < words; ++w) {
    const uint bits = found[thread * words + w];
    if (bits != 0u) atomicOr(evidence[(finger * most + thread) * words + w], bits);
  }
}
