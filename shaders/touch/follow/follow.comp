#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/touch/fingers/fingers.h"
#include "shaders/touch/follow/follow.h"
#include "shaders/touch/follow/follow_math.h"

// Matches this frame's fingers with those of earlier frames, by one group: a thread per track, and the first 64 threads
// also have a finger each. The rules are in docs/touch.md.
layout(local_size_x = 128) in;

layout(std430, set = 0, binding = 0) readonly buffer Header { TouchHeader header; };
layout(std430, set = 0, binding = 1) buffer Fingers { FingerRecord fingers[]; };
layout(std430, set = 0, binding = 2) coherent buffer Tracks { TrackTable table; };
layout(push_constant) uniform Push { FollowPush push; };

const uint most = follow_most_tracks;
const uint columns = follow_most_tracks + fingers_most;  // tracks, then one birth per finger

// For the tracks as they were, moved on to this frame:
shared Float3 place[most];
shared Float3 velocity[most];
shared float reach[most];
shared float penalty[most];
shared uint solid[most];
shared uint owner[most];  // the finger that it becomes, or whose cluster it is in
shared bool merged[most];
shared bool remembered[most];
shared bool seen[most];  // in a cluster that looks like two fingers
shared float stray[most];
shared uint homes[most / 32u];  // a bit per home that is taken
// For the fingers:
shared Float3 found[fingers_most];
shared float birth_cost[fingers_most];
shared uint track_of[fingers_most];
shared uint solid_of[fingers_most];
// For the assignment (Hungarian method by shortest augmenting paths; rows are fingers):
shared float row_price[fingers_most];
shared uint row_of[columns];
shared uint way[columns];
shared uint shortest[2];        // of this step, and of the next: the smallest value, as from ordered(),
shared uint shortest_place[2];  // and its column, as from place_of()

Float3 xyz(vec4 v) {
  return Float3(v.x, v.y, v.z);
}

Axes axes_of(uint finger) {
  const FingerRecord f = fingers[finger];
  return Axes(xyz(f.axis1), xyz(f.axis2), xyz(f.axis3), f.axis1.w, f.axis2.w, f.axis3.w);
}

Sym3 spread_of(uint track) {
  const vec4 a = table.tracks[track].spread_a;
  const vec4 b = table.tracks[track].spread_b;
  return Sym3(a.x, a.y, a.z, a.w, b.x, b.y);
}

float cost_of(uint finger, uint column, float scale) {
  if (column >= most) return column - most == finger ? birth_cost[finger] : out_of_reach;
  if (solid[column] != solid_of[finger]) return out_of_reach;
  return follow_cost(found[finger], place[column], reach[column], scale, penalty[column]);
}

// Integers in the order of the floats; both zeros are the same.
uint ordered(float f) {
  const uint bits = floatBitsToUint(f);
  return f < 0.0 ? ~bits : bits | 0x80000000u;
}
float from_ordered(uint bits) {
  return uintBitsToFloat(bits >= 0x80000000u ? bits & 0x7fffffffu : ~bits);
}
// A column's rank among them: track 0, birth 0, track 1, ...
uint place_of(uint column) {
  return column < most ? 2u * column : 2u * (column - most) + 1u;
}
uint column_at(uint place) {
  return place / 2u + (place % 2u) * most;
}

// The smallest sum of costs; equal costs go to the column with the lower rank. Atomics find the smallest value of a
// step: a loop over the threads' results costs a software device more than everything else here, and more iterations
// than it allows.
void assign(uint count, uint known, float scale) {
  const uint thread = gl_LocalInvocationIndex;
  const uint mine[2] = uint[2](thread, most + thread);
  const bool exists[2] = bool[2](thread < known, thread < count);
  float price[2] = float[2](0.0, 0.0);
  if (exists[0]) row_of[mine[0]] = follow_none;
  if (exists[1]) row_of[mine[1]] = follow_none;
  if (thread < count) row_price[thread] = 0.0;
  for (uint finger = 0u; finger < count; ++finger) {
    float least[2] = float[2](no_cost_yet, no_cost_yet);
    bool visited[2] = bool[2](false, false);
    barrier();
    if (thread == 0u) shortest[0] = shortest_place[0] = 0xffffffffu;
    barrier();
    uint current = follow_none;
    uint row = finger;
    for (uint turn = 0u; turn <= count; ++turn) {
      const uint from = current;
      float best = no_cost_yet;
      uint best_column = follow_none;
      for (uint k = 0u; k < 2u; ++k) {
        if (!exists[k] || visited[k]) continue;
        const float reduced = less(less(cost_of(row, mine[k], scale), row_price[row]), price[k]);
        if (reduced < least[k]) {
          least[k] = reduced;
          way[mine[k]] = from;
        }
        if (least[k] < best) {
          best = least[k];
          best_column = mine[k];
        }
      }
      const uint now = turn % 2u, next = 1u - now;
      const uint mine_ordered = ordered(best);
      if (best_column != follow_none) atomicMin(shortest[now], mine_ordered);
      barrier();
      const uint least_of_all = shortest[now];
      if (best_column != follow_none && mine_ordered == least_of_all) atomicMin(shortest_place[now], place_of(best_column));
      if (thread == 0u) shortest[next] = shortest_place[next] = 0xffffffffu;
      barrier();
      current = column_at(shortest_place[now]);
      const float delta = from_ordered(least_of_all);
      for (uint k = 0u; k < 2u; ++k) {
        if (!exists[k]) continue;
        if (visited[k]) {
          row_price[row_of[mine[k]]] = plus(row_price[row_of[mine[k]]], delta);
          price[k] = less(price[k], delta);
        } else {
          least[k] = less(least[k], delta);
        }
        if (mine[k] == current) visited[k] = true;
      }
      if (thread == 0u) row_price[finger] = plus(row_price[finger], delta);
      barrier();
      row = row_of[current];
      if (row == follow_none) break;
    }
    barrier();  // all have seen the end of the path
    if (thread == 0u) {
      uint column = current;
      for (uint step = 0u; step <= count && column != follow_none; ++step) {
        const uint before = way[column];
        row_of[column] = before == follow_none ? finger : row_of[before];
        column = before;
      }
    }
  }
  barrier();
}

// The finger into whose cluster an unmatched track has merged, or follow_none. If the track is in the ellipsoids of
// several, it is the one in which it is deepest; if in none, the one that it was in before.
uint cluster_around(uint track, uint before, uint count) {
  uint best_finger = before;
  float best = 1.0;
  for (uint f = 0u; f < count; ++f) {
    if (solid_of[f] != solid[track]) continue;
    const float square = inside_square(axes_of(f), minus(place[track], found[f]));
    if (square < best) {
      best = square;
      best_finger = f;
    }
  }
  return best_finger;
}

// The places and velocities of the fingers that make up a merged cluster.
void move_cluster(uint finger, uint track, uint passengers, uint known, float frame_s) {
  const Axes axes = axes_of(finger);
  const Sym3 cluster = covariance_of(axes);
  const float gain = velocity_gain(frame_s);
  float total = float(table.tracks[track].contacts);
  uint other = track;
  for (uint u = 0u; u < known; ++u) {
    if (!merged[u] || owner[u] != finger) continue;
    total = plus(total, float(table.tracks[u].contacts));
    other = u;
  }
  Float3 mean = Float3(0.0, 0.0, 0.0);
  for (uint u = 0u; u < known; ++u) {
    if (u == track || (merged[u] && owner[u] == finger)) mean = moved(mean, place[u], float(table.tracks[u].contacts) / total);
  }
  const Float3 shift = minus(found[finger], mean);
  for (uint u = 0u; u < known; ++u) {
    if (u != track && !(merged[u] && owner[u] == finger)) continue;
    place[u] = moved(place[u], shift, 1.0);
    velocity[u] = moved(velocity[u], shift, gain);
  }
  if (passengers == 1u) {
    const float share = float(table.tracks[track].contacts) / total;
    const float other_share = float(table.tracks[other].contacts) / total;
    const Parting parting =
        parting_of(cluster, spread_of(track), spread_of(other), share, other_share, minus(place[other], place[track]));
    const float part = product(0.5, parting.trust);
    place[track] = moved(place[track], parting.correction, -product(other_share, part));
    place[other] = moved(place[other], parting.correction, product(share, part));
    velocity[track] = moved(velocity[track], parting.correction, -product(product(other_share, part), gain));
    velocity[other] = moved(velocity[other], parting.correction, product(product(share, part), gain));
  }
  const bool looks = looks_merged(cluster, spread_of(track));
  for (uint u = 0u; u < known; ++u) {
    if (u != track && !(merged[u] && owner[u] == finger)) continue;
    const Float3 offset = kept_inside(axes, minus(place[u], found[finger]));
    place[u] = moved(found[finger], offset, 1.0);
    stray[u] = sqrt(dot3(offset, offset));
    seen[u] = looks;
  }
}

// The `nth` free home.
uint free_home(uint nth) {
  uint left = nth;
  for (uint h = 0u; h < most; ++h) {
    if ((homes[h / 32u] >> (h % 32u) & 1u) != 0u) continue;
    if (left == 0u) return h;
    --left;
  }
  return 0u;  // never reached: there are no more tracks than homes
}

// The track of a finger after this frame, the `born`th new one if it is new; its record gets id and steady axes.
Track followed(uint finger, uint first_id, uint born, uint known, uint elapsed_us) {
  const FingerRecord record = fingers[finger];
  const Axes axes = axes_of(finger);
  const uint track = track_of[finger];
  const Sym3 spread = covariance_of(axes);
  Track t;
  t.id = first_id + born;
  t.since_us = follow_restart;
  t.solid = record.solid;
  t.contacts = record.contacts;
  t.flags = record.point_like == 0u ? track_has_axes : 0u;
  t.place = vec4(found[finger].x, found[finger].y, found[finger].z, 0.0);
  t.velocity = vec4(0.0);
  t.axis1 = record.axis1;
  t.axis3 = record.axis3;
  t.spread_a = vec4(spread.xx, spread.xy, spread.xz, spread.yy);
  t.spread_b = vec4(spread.yz, spread.zz, 0.0, 0.0);
  const Float3 lean = xyz(record.lean);
  Steady steady;
  steady.axes = axes;
  steady.cosine = 1.0;
  steady.sine = 0.0;
  bool has_frame = false;
  if (track == follow_none) {
    t.home = free_home(born);
  } else {
    const Track old = table.tracks[track];
    t.home = old.home;
    const uint since_us = later(old.unseen_us, elapsed_us);
    if (glides_on(old.flags, old.unseen_us, since_us)) t.since_us = since_us;
    const float since_s = in_seconds(since_us);
    uint passengers = 0u;
    for (uint u = 0u; u < known; ++u) passengers += merged[u] && owner[u] == finger ? 1u : 0u;
    t.id = old.id;
    if (passengers == 0u) {
      velocity[track] = moved(velocity[track], minus(found[finger], place[track]), velocity_gain(since_s));
    } else {
      move_cluster(finger, track, passengers, known, in_seconds(elapsed_us));
      t.contacts = old.contacts;
      t.spread_a = old.spread_a;
      t.spread_b = old.spread_b;
      t.place = vec4(place[track].x, place[track].y, place[track].z, stray[track]);
    }
    t.velocity = vec4(velocity[track].x, velocity[track].y, velocity[track].z, 0.0);
    const bool had_axes = (old.flags & track_has_axes) != 0u;
    if (had_axes && record.point_like != 0u) {
      t.flags = track_has_axes;
      t.axis1 = old.axis1;
      t.axis3 = old.axis3;
    } else if (had_axes) {
      has_frame = true;
      if (push.steady != 0u) steady = steady_axes(axes, lean, xyz(old.axis1), xyz(old.axis3), since_s);
    }
  }
  if (push.steady != 0u && record.point_like == 0u) {
    if (!has_frame) steady = first_axes(axes, lean);
    const Axes a = steady.axes;
    t.axis1 = vec4(a.w1.x, a.w1.y, a.w1.z, a.l1);
    t.axis3 = vec4(a.w3.x, a.w3.y, a.w3.z, a.l3);
    fingers[finger].axis1 = t.axis1;
    fingers[finger].axis2 = vec4(a.w2.x, a.w2.y, a.w2.z, a.l2);
    fingers[finger].axis3 = t.axis3;
    fingers[finger].turn = vec4(steady.cosine, steady.sine, 0.0, 0.0);
  }
  fingers[finger].id = t.id;
  t.carrier = follow_none;
  t.unseen_us = 0u;
  return t;
}

void main() {
  const uint thread = gl_LocalInvocationIndex;
  const uint count = min(header.fingers, fingers_most);
  const bool restart = push.elapsed_us == follow_restart;
  const uint elapsed_us = restart ? 0u : push.elapsed_us;
  const uint known = restart ? 0u : min(table.count, most);
  const uint first_id = restart ? 0u : table.next_id;
  const float frame_s = in_seconds(elapsed_us);
  const float scale = reach_of(frame_s, 0.0, 0.0);

  Track old;
  bool alive = false;
  uint unseen_us = 0u;
  if (thread < known) {
    old = table.tracks[thread];
    unseen_us = later(old.unseen_us, elapsed_us);
    const bool carried = old.carrier != follow_none;
    alive = unseen_us <= memory_of(carried, push.memory_us);
    const uint coasts_us = min(unseen_us, coasting_us) - min(old.unseen_us, coasting_us);
    place[thread] = moved(xyz(old.place), xyz(old.velocity), carried ? frame_s : in_seconds(coasts_us));
    velocity[thread] = xyz(old.velocity);
    reach[thread] = reach_of(frame_s, in_seconds(old.unseen_us), old.place.w);
    penalty[thread] = old.unseen_us == 0u && !carried ? 0.0 : second_class;
    solid[thread] = alive ? old.solid : follow_none;
  }
  if (thread < count) {
    found[thread] = xyz(fingers[thread].centre);
    solid_of[thread] = fingers[thread].solid;
    track_of[thread] = follow_none;
  }
  barrier();

  if (thread < count) {
    float birth = new_finger;
    for (uint t = 0u; t < known; ++t) {
      if (penalty[t] == 0.0 && reach[t] <= scale) continue;
      const float cost = cost_of(thread, t, scale);
      if (cost < out_of_reach) birth = max(birth, plus(cost, 1.0));
    }
    birth_cost[thread] = birth;
  }
  barrier();
  assign(count, known, scale);

  if (thread < known) {
    const uint taken = row_of[thread];
    owner[thread] = taken;
    merged[thread] = false;
    if (taken != follow_none) {
      track_of[taken] = thread;
    } else if (alive && (old.carrier != follow_none || old.unseen_us <= coasting_us)) {
      const uint before = old.carrier < known ? row_of[old.carrier] : follow_none;
      owner[thread] = cluster_around(thread, before, count);
      merged[thread] = owner[thread] != follow_none;
    }
    seen[thread] = false;
    stray[thread] = 0.0;
    remembered[thread] = taken == follow_none && alive && (merged[thread] || unseen_us <= push.memory_us);
  }
  if (thread < most / 32u) homes[thread] = 0u;
  barrier();
  uint slot = count;
  for (uint t = 0u; t < min(thread, known); ++t) slot += remembered[t] ? 1u : 0u;
  const bool stays = thread < known && remembered[thread] && slot < most;
  if (stays || (thread < known && row_of[thread] != follow_none)) atomicOr(homes[old.home / 32u], 1u << old.home % 32u);
  barrier();

  Track fresh;
  if (thread < count) {
    uint born = 0u;
    for (uint f = 0u; f < thread; ++f) born += track_of[f] == follow_none ? 1u : 0u;
    fresh = followed(thread, first_id, born, known, elapsed_us);
  }
  memoryBarrierBuffer();
  barrier();

  if (thread < count) table.tracks[thread] = fresh;
  if (stays) {
    old.carrier = merged[thread] ? owner[thread] : follow_none;
    if (merged[thread]) old.flags |= track_left_home;
    old.unseen_us = seen[thread] ? 0u : unseen_us;
    old.place = vec4(place[thread].x, place[thread].y, place[thread].z, stray[thread]);
    old.velocity = vec4(velocity[thread].x, velocity[thread].y, velocity[thread].z, 0.0);
    table.tracks[slot] = old;
  }
  if (thread == 0u) {
    uint born = 0u;
    for (uint f = 0u; f < count; ++f) born += track_of[f] == follow_none ? 1u : 0u;
    uint total = count;
    for (uint t = 0u; t < known; ++t) total += remembered[t] ? 1u : 0u;
    table.count = min(total, most);
    table.next_id = first_id + born;
  }
}
