#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/touch/clusters/clusters.h"
#include "shaders/touch/clusters/clusters_math.h"

// Groups of cells with so many contacts that a few tests pair by pair decided nothing: one thread per pair of groups.
// Bounds come first, which look at every contact only once. Each side is repeatedly narrowed down to its contacts near
// the other side's box. Then a line is searched along which the sides are farther apart. The result is exact: bounds
// only save work, tests decide. They are done here or, if they are too many for one thread, in clusters_undecided.
layout(local_size_x = 64) in;

layout(set = 0, binding = 0) uniform usamplerBuffer nodes;
layout(std430, set = 0, binding = 1) writeonly buffer Undecided { CrowdedPair undecided[]; };
layout(std430, set = 0, binding = 2) readonly buffer Crowded { CrowdedPair crowded[]; };
layout(std430, set = 0, binding = 3) buffer Work { ClustersWork work; };
layout(std430, set = 0, binding = 4) buffer Forest { uint forest[]; };
layout(set = 0, binding = 5) uniform usamplerBuffer seen;
layout(push_constant) uniform Push { ClustersPush push; };

#include "shaders/touch/clusters/clusters_cells.glsl"
#include "shaders/touch/clusters/clusters_contacts.glsl"
#include "shaders/touch/clusters/clusters_undecided.glsl"
#include "shaders/touch/clusters/clusters_union.glsl"

// Bounds are loosened and tightened by far more than the rounding error.
const float loose = 1.0001;
const float tight = 0.9999;

// Iterations of one loop, four contacts each. There are at most 17 loops of keep() and two of farthest() per line, then
// the tests: together fewer than a software device allows, see clusters.h.
const uint most_turns = 1536u;
const uint most_lines = 8u;
const uint most_test_turns = 8192u;

const uint apart = 0u;
const uint together = 1u;
const uint unknown = 2u;

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
  bool whole;    // the walk reached its end
};

void keep_next(inout Walk w, inout Kept kept, vec3 low, vec3 high) {
  if (at_end(w)) return;
  const vec3 p = take(w);
  if (square_outside(p, low, high) > push.limit * loose) return;
  const vec3 farthest = max(abs(p - low), abs(p - high));
  kept.reached = kept.reached || dot(farthest, farthest) <= push.limit * tight;
  kept.low = min(kept.low, p);
  kept.high = max(kept.high, p);
  kept.sum += p;
  ++kept.count;
}

Kept keep(Walk w, vec3 low, vec3 high) {
  Kept kept = Kept(vec3(3.0e38), vec3(-3.0e38), vec3(0.0), 0u, false, false);
  for (uint turn = 0u; turn < most_turns && !at_end(w); ++turn) {
    keep_next(w, kept, low, high);
    keep_next(w, kept, low, high);
    keep_next(w, kept, low, high);
    keep_next(w, kept, low, high);
  }
  kept.whole = at_end(w);
  return kept;
}

// Place, relative to `origin`, of the contact of a walk that is farthest along a direction.
struct Farthest {
  vec3 at;
  float along;
};

void look_at_next(inout Walk w, inout Farthest best, vec3 origin, vec3 direction) {
  if (at_end(w)) return;
  const vec3 p = take(w) - origin;
  const float along = dot(p, direction);
  if (along > best.along) best = Farthest(p, along);
}

Farthest farthest(Walk w, vec3 origin, vec3 direction) {
  Farthest best = Farthest(vec3(0.0), -3.0e38);
  for (uint turn = 0u; turn < most_turns && !at_end(w); ++turn) {
    look_at_next(w, best, origin, direction);
    look_at_next(w, best, origin, direction);
    look_at_next(w, best, origin, direction);
    look_at_next(w, best, origin, direction);
  }
  return best;
}

// A driver compiles each call of a function again. So keep() and farthest() have one call each, for both sides in turn.
Walk side_of(Walk one, Walk other, uint side) {
  if (side == 0u) return one;
  return other;
}

// Whether the sides are farther apart than the gap along some line: first along the line between their centres, then
// along the smallest known difference between the two (Gilbert 1966).
bool separated(Walk one, Walk other, Kept a, Kept b) {
  const vec3 origin = a.sum / float(a.count);
  vec3 difference = b.sum / float(b.count) - origin;
  for (uint line = 0u; line < most_lines; ++line) {
    const float square = dot(difference, difference);
    if (!(square > push.limit)) return false;
    const vec3 direction = difference * inversesqrt(square);
    Farthest end;
    Farthest start;
    for (uint side = 0u; side < 2u; ++side) {
      start = farthest(side_of(one, other, side), origin, side == 0u ? direction : -direction);
      if (side == 0u) end = start;
    }
    const float between = -start.along - end.along;
    if (between > 0.0 && between * between > push.limit * loose) return true;
    const vec3 step = start.at - end.at - difference;
    difference += step * clamp(-dot(difference, step) / dot(step, step), 0.0, 1.0);
  }
  return false;
}

// Tests pair by pair, in one loop: an iteration takes the next contact of one side, or four contacts of the other.
uint tested(Walk one, Walk other, Kept b) {
  Walk rest = Walk(other.block, 0u, clusters_nothing);  // of the other side, for p
  vec3 p = vec3(0.0);
  bool hit = false;
  for (uint turn = 0u; turn < most_test_turns && !hit && !(at_end(rest) && at_end(one)); ++turn) {
    if (at_end(rest)) {
      p = take(one);
      if (square_outside(p, b.low, b.high) <= push.limit * loose) rest = other;
    }
    hit = next_in_reach(rest, p);
    hit = next_in_reach(rest, p) || hit;
    hit = next_in_reach(rest, p) || hit;
    hit = next_in_reach(rest, p) || hit;
  }
  if (hit) return together;
  return at_end(rest) && at_end(one) ? apart : unknown;
}

uint within_gap(Walk one, Walk other) {
  Kept a;
  Kept b = Kept(vec3(-1.0e18), vec3(1.0e18), vec3(0.0), 0u, false, true);
  uint before = 0u;
  for (uint turn = 0u; turn < 17u; ++turn) {
    const uint side = turn % 2u;
    const Kept kept = keep(side_of(one, other, side), side == 0u ? b.low : a.low, side == 0u ? b.high : a.high);
    if (kept.reached) return together;
    if (!kept.whole) return unknown;
    if (kept.count == 0u) return apart;
    if (side == 1u) {
      b = kept;
      continue;
    }
    a = kept;
    const uint count = a.count + b.count;
    if (turn >= 4u && count * 8u > before * 7u) break;
    before = count;
  }
  return separated(one, other, a, b) ? apart : tested(one, other, b);
}

void defer(CrowdedPair pair) {
  const uint place = atomicAdd(work.undecided, 1u);
  if (place >= undecided_room(push.most_contacts)) return;
  undecided[place] = pair;
  atomicMax(work.undecided_x, undecided_groups(place));
}

void main() {
  const uint room = push.most_contacts * clusters_crowded_per_contact;
  const uint i = gl_GlobalInvocationID.x;
  if (i == 0u && work.crowded > room) work.rest_x = min(work.blocks, rest_most_groups);
  if (i >= min(work.crowded, room)) return;
  const CrowdedPair pair = crowded[i];
  const Block a = Block(pair.first_a, pair.cells_a & 0xffu);
  const Block b = Block(pair.first_b, pair.cells_b & 0xffu);
  const uint group_a = pair.cells_a >> 8u;
  const uint group_b = pair.cells_b >> 8u;
  const uint cell_a = cell_number(a, uint(findLSB(group_a)));
  const uint cell_b = cell_number(b, uint(findLSB(group_b)));
  if (seen_root(cell_a) == seen_root(cell_b)) return;
  const uint verdict = within_gap(walk(a, group_a), walk(b, group_b));
  if (verdict == together) unite(cell_a, cell_b);
  if (verdict == unknown) defer(pair);
}
