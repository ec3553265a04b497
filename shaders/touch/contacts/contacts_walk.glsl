// The common part of the kernels that look for contacts. In walk(), a group goes over its range of the points and
// leaves a bit and a Hit for each contact, and their number. Include this file after the definition of
//   float look(SolidRecord solid, Float3 p, float delta, out bool shell)
// It returns the depth inside the solid of a point of the solid's box, in the solid's coordinates, and whether it is
// less than delta. 0: outside, or deeper if deep points are not asked for.
shared uint found[contacts_most_words];
shared uint deep_found[contacts_most_words];
shared uint sum, deep_sum;

// The finger around which the point lies, or reach_none.
uint reaching_finger(Float3 point) {
  if (push.elapsed_us == reach_none) return reach_none;
  const uint count = min(reach.count, reach_most_fingers);
  const float elapsed_s = seconds_of(push.elapsed_us);
  for (uint k = 0u; k < count; ++k) {
    if (is_around(reach.fingers[k], point, elapsed_s)) return k;
  }
  return reach_none;
}

bool in_box(vec3 p, vec3 low, vec3 high) {
  return all(greaterThanEqual(p, low)) && all(lessThanEqual(p, high));
}

// The first solid that the point is a contact of, with its depth. If there is none and deep points are asked for, the
// first solid in which it is a deep point. Depth 0: neither.
Hit find_at(Float3 point, out bool deep) {
  deep = false;
  Hit hit = Hit(0u, 0.0);
  const uint count = one_solid ? 1u : push.solids;
  for (uint s = 0u; s < count && (hit.depth == 0.0 || deep); ++s) {
    SolidRecord solid = push.only;
    if (!one_solid) solid = solids[s];
    const Float3 p = in_solid(point, solid.centre, solid.turn);
    if (!in_box(vec3(p.x, p.y, p.z), solid.low.xyz, solid.high.xyz)) continue;
    const float delta = solid.delta > 0.0 ? solid.delta : push.delta;
    bool shell;
    const float depth = look(solid, p, delta, shell);
    if (depth == 0.0 || (!shell && (!with_deep || deep))) continue;
    deep = !shell;
    hit = Hit(s, depth);
  }
  return hit;
}

// A point around a known finger that is about to end is also tested deeper and shallower. There is one loop, so that the
// test is compiled once.
Hit find(Float3 point, out bool deep) {
  Hit hit = Hit(0u, 0.0);
  deep = false;
  const uint finger = reaching_finger(point);
  const uint tests = finger == reach_none ? 1u : 3u;
  for (uint t = 0u; t < tests; ++t) {
    Float3 at = point;
    if (t > 0u) at = shifted(point, reach.fingers[finger].inward, t == 1u);
    bool is_deep;
    const Hit here = find_at(at, is_deep);
    const bool shell = here.depth != 0.0 && !is_deep;
    if (t == 0u) {
      hit = here;
      deep = is_deep;
    } else if (shell && here.solid == reach.fingers[finger].solid) {
      hit = Hit(here.solid | hit_beyond, here.depth);
      deep = false;
    }
    if (hit.depth != 0.0 && !deep) break;
  }
  return hit;
}

void walk() {
  const uint thread = gl_LocalInvocationIndex;
  const uint count = min(given.total, push.most_points);
  const uint chunk = points_per_chunk(count);
  const uint first = gl_WorkGroupID.x * chunk;
  const uint last = min(first + chunk, count);
  if (first >= count) {  // the whole group
    if (thread == 0u) {
      counts[gl_WorkGroupID.x] = 0u;
      if (with_deep) deep_counts[gl_WorkGroupID.x] = 0u;
    }
    return;
  }
  const uint words = chunk / 32u;
  for (uint w = thread; w < words; w += contacts_group) {
    found[w] = 0u;
    if (with_deep) deep_found[w] = 0u;
  }
  if (thread == 0u) {
    sum = 0u;
    deep_sum = 0u;
  }
  barrier();

  for (uint i = first + thread; i < last; i += contacts_group) {
    const Float3 point = xyz_of(uintBitsToFloat(points[i]));
    if (!is_finite(point.x) || !is_finite(point.y) || !is_finite(point.z)) continue;
    bool deep;
    const Hit hit = find(point, deep);
    if (hit.depth == 0.0) continue;
    hits[i] = hit;
    if (with_deep && deep) {
      atomicOr(deep_found[(i - first) >> 5u], 1u << (i & 31u));
    } else {
      atomicOr(found[(i - first) >> 5u], 1u << (i & 31u));
    }
  }
  barrier();

  uint mine = 0u;
  uint mine_deep = 0u;
  for (uint w = thread; w < words; w += contacts_group) {
    masks[first / 32u + w] = found[w];
    mine += uint(bitCount(found[w]));
    if (with_deep) {
      deep_masks[first / 32u + w] = deep_found[w];
      mine_deep += uint(bitCount(deep_found[w]));
    }
  }
  if (mine != 0u) atomicAdd(sum, mine);
  if (mine_deep != 0u) atomicAdd(deep_sum, mine_deep);
  barrier();
  if (thread == 0u) {
    counts[gl_WorkGroupID.x] = sum;
    if (with_deep) deep_counts[gl_WorkGroupID.x] = deep_sum;
  }
}
