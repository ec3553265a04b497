#version 460
#extension GL_GOOGLE_include_directive : require
#include "contacts.h"
#include "fingers.h"
#include "fingers_math.h"
#include "scan.h"

// Groups of cells with so many contacts that testing pair by pair showed nothing soon. Bounds first, which look at every
// contact only once: each side is narrowed down to its contacts near the other side's box, again and again; then a gap is
// looked for along the line between the centres. Exact: bounds only spare work, the test itself decides.
layout(local_size_x = 64) in;

layout(std430, set = 0, binding = fingers_total) readonly buffer Total { ScanTotal found; };
layout(set = 0, binding = fingers_nodes) uniform usamplerBuffer nodes;
layout(std430, set = 0, binding = fingers_crowded) readonly buffer Crowded { CrowdedPair crowded[]; };
layout(std430, set = 0, binding = fingers_work) buffer Work { FingersWork work; };
layout(std430, set = 0, binding = fingers_forest) buffer Forest { uint forest[]; };
layout(set = 0, binding = fingers_seen) uniform usamplerBuffer seen;
layout(push_constant) uniform Push { FingersPush push; };

uint most_steps = 0u;
#include "fingers_cells.glsl"
#include "fingers_union.glsl"

// Bounds are loosened and tightened by far more than rounding.
const float loose = 1.0001;
const float tight = 0.9999;

// A walk through the contacts of some cells of a block.
struct Walk {
  Block block;
  uint cells;
  uint contact;  // fingers_nothing at the end
};

void skip_to_contact(inout Walk w) {
  if (w.contact == fingers_nothing && w.cells != 0u) {
    w.contact = cell_number(w.block, uint(findLSB(w.cells)));
    w.cells &= w.cells - 1u;
  }
}

Walk walk(Block block, uint cells) {
  Walk w = Walk(block, cells, fingers_nothing);
  skip_to_contact(w);
  return w;
}

vec3 take(inout Walk w) {
  const uvec4 node = texelFetch(nodes, int(w.contact));
  w.contact = node.w;
  skip_to_contact(w);
  return uintBitsToFloat(node.xyz);
}

float square_outside(vec3 p, vec3 low, vec3 high) {
  const vec3 outside = max(max(low - p, p - high), vec3(0.0));
  return dot(outside, outside);
}

// The contacts of a walk that are within the gap of a box.
struct Kept {
  vec3 low;
  vec3 high;
  vec3 sum;
  uint count;
  bool reached;  // one of them is within the gap of everything in the box
};

Kept keep(Walk w, vec3 low, vec3 high) {
  Kept kept = Kept(vec3(3.0e38), vec3(-3.0e38), vec3(0.0), 0u, false);
  for (uint step = 0u; step < most_steps && w.contact != fingers_nothing; ++step) {
    const vec3 p = take(w);
    if (square_outside(p, low, high) > push.limit * loose) continue;
    const vec3 farthest = max(abs(p - low), abs(p - high));
    kept.reached = kept.reached || dot(farthest, farthest) <= push.limit * tight;
    kept.low = min(kept.low, p);
    kept.high = max(kept.high, p);
    kept.sum += p;
    ++kept.count;
  }
  return kept;
}

// Whether the sides are farther apart than the gap along the line between their centres.
bool separated(Walk one, Walk other, Kept a, Kept b) {
  const vec3 origin = a.sum / float(a.count);
  const vec3 line = b.sum / float(b.count) - origin;
  const float square = dot(line, line);
  if (!(square > 0.0)) return false;
  const vec3 direction = line * inversesqrt(square);
  float end = -3.0e38;
  float start = 3.0e38;
  for (uint step = 0u; step < most_steps && one.contact != fingers_nothing; ++step) {
    end = max(end, dot(take(one) - origin, direction));
  }
  for (uint step = 0u; step < most_steps && other.contact != fingers_nothing; ++step) {
    start = min(start, dot(take(other) - origin, direction));
  }
  const float between = start - end;
  return between > 0.0 && between * between > push.limit * loose;
}

bool any_in_reach(Walk one, Walk other, Kept b) {
  for (uint step = 0u; step < most_steps && one.contact != fingers_nothing; ++step) {
    const vec3 p = take(one);
    if (square_outside(p, b.low, b.high) > push.limit * loose) continue;
    Walk inner = other;
    for (uint turn = 0u; turn < most_steps && inner.contact != fingers_nothing; ++turn) {
      const vec3 q = take(inner);
      if (in_reach(Float3(p.x, p.y, p.z), Float3(q.x, q.y, q.z), push.limit)) return true;
    }
  }
  return false;
}

bool within_gap(Walk one, Walk other) {
  Kept a = keep(one, vec3(-1.0e18), vec3(1.0e18));
  Kept b = a;
  for (uint round = 0u; round < 8u; ++round) {
    const uint before = a.count + b.count;
    b = keep(other, a.low, a.high);
    if (b.count == 0u || b.reached) return b.reached;
    a = keep(one, b.low, b.high);
    if (a.count == 0u || a.reached) return a.reached;
    if (round > 0u && (a.count + b.count) * 8u > before * 7u) break;
  }
  return !separated(one, other, a, b) && any_in_reach(one, other, b);
}

void main() {
  const uint contacts = min(found.total, push.most_contacts);
  const uint room = push.most_contacts / fingers_contacts_per_crowded;
  const uint pairs = min(work.crowded, room);
  const uint threads = gl_NumWorkGroups.x * blocks_group;
  if (gl_GlobalInvocationID.x == 0u && work.crowded > room) work.rest_x = blocks_most_groups;
  most_steps = contacts;
  for (uint i = gl_GlobalInvocationID.x; i < pairs; i += threads) {
    const CrowdedPair pair = crowded[i];
    const Block a = Block(pair.first_a, pair.cells_a & 0xffu);
    const Block b = Block(pair.first_b, pair.cells_b & 0xffu);
    const uint group_a = pair.cells_a >> 8u;
    const uint group_b = pair.cells_b >> 8u;
    const uint cell_a = cell_number(a, uint(findLSB(group_a)));
    const uint cell_b = cell_number(b, uint(findLSB(group_b)));
    if (seen_root(cell_a) == seen_root(cell_b)) continue;
    if (within_gap(walk(a, group_a), walk(b, group_b))) unite(cell_a, cell_b);
  }
}
