#version 460
#extension GL_GOOGLE_include_directive : require
#include "shaders/touch/contacts/contacts.h"
#include "shaders/touch/fingers/fingers.h"
#include "shaders/touch/split/split_math.h"
#include "shaders/touch/known/known_math.h"

// One finger per group, only if it is too wide: finds the samples of each of its parts. A thread per sample; a part is
// named by its first sample. Sets of samples are 64 bits. (A software device ends all loops of a shader after 65,535
// iterations together, so sums are kept, and sets are walked bit by bit.)
layout(local_size_x = 64) in;

layout(std430, set = 0, binding = 0) readonly buffer Shown { SplitEvidence evidence[]; };
layout(std430, set = 0, binding = 1) readonly buffer Samples { BridgeSample samples[]; };
layout(std430, set = 0, binding = 2) buffer States { SplitState states[]; };
layout(std430, set = 0, binding = 3) writeonly buffer Labels { uint labels[]; };
layout(std430, set = 0, binding = 4) writeonly buffer Clusters { Cluster clusters[]; };
layout(std430, set = 0, binding = 5) coherent buffer Known { KnownTable known; };
layout(push_constant) uniform Push { SplitPush push; };

const uint most = bridge_samples;

shared Float3 places[most];
shared Float3 normals[most];
shared Float3 insides[most];
shared uint links[most * most];  // of two groups, by their first samples: pairs that show two fingers, times 2^16, plus
                                 // those known
shared uvec2 same[most];
shared uint head[most];
shared uvec2 members[most];
shared Float3 means[most];
shared uint best[most];
shared SplitLink best_link[most];
shared float best_square[most];
shared uint joined;
shared uint labels_of[most];     // the samples' known fingers
shared uvec2 kin[most];          // samples of the same known finger
shared uint group_label[most];   // of a group, by its first sample: the known finger of most of its samples
shared uint known_low, known_high;
shared uint label_parts[known_fingers];  // of each known finger: how many parts have most of their samples of it,
shared uint label_part[known_fingers];   // and the first of them

uvec2 only(uint s) {
  return s < 32u ? uvec2(1u << s, 0u) : uvec2(0u, 1u << (s - 32u));
}
bool holds(uvec2 set, uint s) {
  return (set & only(s)) != uvec2(0u);
}
uint size_of(uvec2 set) {
  return uint(bitCount(set.x) + bitCount(set.y));
}

uint first_of(uvec2 set) {
  return set.x != 0u ? uint(findLSB(set.x)) : 32u + uint(findLSB(set.y));
}
uvec2 without_first(uvec2 set) {
  return set.x != 0u ? uvec2(set.x & (set.x - 1u), set.y) : uvec2(0u, set.y & (set.y - 1u));
}

uvec2 looked_of(uint s) {
  const SplitEvidence e = evidence[gl_WorkGroupID.x * most + s];
  return uvec2(e.looked_low, e.looked_high);
}
uvec2 valley_of(uint s) {
  const SplitEvidence e = evidence[gl_WorkGroupID.x * most + s];
  return uvec2(e.valley_low, e.valley_high);
}

// Collects the members of the groups from their samples' heads.
void gather(uint count) {
  const uint thread = gl_LocalInvocationIndex;
  uvec2 set = uvec2(0u);
  for (uint s = 0u; s < count; ++s) {
    if (head[s] == thread) set |= only(s);
  }
  barrier();
  members[thread] = set;
  barrier();
}

// Joins the two groups that thread 0 has chosen, `joined` and its best (the later one), and their links.
void join() {
  const uint thread = gl_LocalInvocationIndex;
  const uint keeps = joined, goes = best[joined];
  const uint sum = links[keeps * most + thread] + links[goes * most + thread];
  if (head[thread] == goes) head[thread] = keeps;
  if (thread == 0u) {
    members[keeps] |= members[goes];
    members[goes] = uvec2(0u);
  }
  barrier();
  if (thread != keeps && thread != goes) {
    links[keeps * most + thread] = sum;
    links[thread * most + keeps] = sum;
  }
  barrier();
}

// The known finger of most samples of a group; if two have equally many, that of the first sample.
uint label_of(uint group) {
  uint most_kin = 0u;
  uint label = known_none;
  for (uvec2 left = members[group]; left != uvec2(0u); left = without_first(left)) {
    const uint s = first_of(left);
    const uint relatives = size_of(members[group] & kin[s]);
    if (relatives > most_kin) {
      most_kin = relatives;
      label = labels_of[s];
    }
  }
  return label;
}

SplitLink link_between(uint a, uint b) {
  const uint link = links[a * most + b];
  return SplitLink(link & 0xffffu, link >> 16u);
}

// Groups samples, the most certain pair first. A thread keeps the best partner of its group from round to round,
// because a join changes the links of one group only.
void grow(uint count) {
  const uint thread = gl_LocalInvocationIndex;
  uint found = fingers_nothing;
  SplitLink found_link = SplitLink(0u, 0u);
  bool search_again = thread < count;
  for (uint round = 1u; round < count; ++round) {
    if (search_again) {
      found = fingers_nothing;
      for (uint b = thread + 1u; b < count; ++b) {
        const SplitLink link = link_between(thread, b);
        if (head[b] != b || !can_grow(link) || (found != fingers_nothing && !surer(link, found_link))) continue;
        found = b;
        found_link = link;
      }
    }
    best[thread] = found;
    best_link[thread] = found_link;
    barrier();
    if (thread == 0u) {
      uint a = fingers_nothing;
      for (uint s = 0u; s < count; ++s) {
        if (best[s] != fingers_nothing && (a == fingers_nothing || surer(best_link[s], best_link[a]))) a = s;
      }
      joined = a;
    }
    barrier();
    if (joined == fingers_nothing) break;  // the whole group
    const uint keeps = joined, goes = best[joined];
    join();
    const bool stays = thread < count && head[thread] == thread;
    search_again = stays && (thread == keeps || found == keeps || found == goes);
    if (!stays) {
      found = fingers_nothing;
    } else if (!search_again && thread < keeps) {
      const SplitLink link = link_between(thread, keeps);
      const bool is_first = found == fingers_nothing || (keeps < found && !surer(found_link, link));  // if both are
                                                                                                      // equally certain
      if (can_grow(link) && (is_first || surer(link, found_link))) {
        found = keeps;
        found_link = link;
      }
    }
  }
  barrier();
}

// Each sample goes to the group that it has chosen. Groups are named by their first samples.
void regroup(uint chosen, uint count) {
  const uint thread = gl_LocalInvocationIndex;
  barrier();
  best[thread] = chosen;
  barrier();
  uint first = thread;
  for (uint s = count; s > 0u; --s) {
    if (best[s - 1u] == chosen) first = s - 1u;
  }
  head[thread] = thread < count ? first : thread;
  barrier();
  gather(count);
}

// Each sample goes to the group of most of the samples with the same inside.
void vote(uint count) {
  const uint thread = gl_LocalInvocationIndex;
  uint chosen = head[thread];
  if (thread < count) {
    uint most_same = size_of(same[thread] & members[chosen]);
    for (uint h = 0u; h < count; ++h) {
      const uint size = size_of(same[thread] & members[h]);
      if (size > most_same) {
        most_same = size;
        chosen = h;
      }
    }
  }
  regroup(chosen, count);
}

bool were_apart(uint a, uint b) {
  return group_label[a] != known_none && group_label[b] != known_none && group_label[a] != group_label[b];
}

// Whether two groups of known fingers may be one. Call it only for groups that were apart.
bool may_be_one(uint a, uint b) {
  return may_meet(known.fingers[group_label[a]], push.elapsed_us) && may_meet(known.fingers[group_label[b]], push.elapsed_us);
}

// Notes which known fingers look like one with another in this frame, and which ones look like several. Parts of a known
// finger that may not part are joined. settle() has left the parts' means and links.
void hold(uint count) {
  const uint thread = gl_LocalInvocationIndex;
  label_parts[thread] = 0u;
  label_part[thread] = most;
  barrier();
  const bool leads = thread < count && head[thread] == thread;
  if (leads) {
    group_label[thread] = label_of(thread);
    if (group_label[thread] != known_none) {
      atomicAdd(label_parts[group_label[thread]], 1u);
      atomicMin(label_part[group_label[thread]], thread);
    }
  }
  barrier();
  if (leads) {
    for (uint b = thread + 1u; b < count; ++b) {
      if (head[b] != b || !were_apart(thread, b)) continue;
      if (are_fingers(link_between(thread, b), square_apart(means[thread], means[b]), push.finger_width, true)) continue;
      atomicOr(known.doubts[group_label[thread]], doubt_apart);
      atomicOr(known.doubts[group_label[b]], doubt_apart);
    }
  }
  if (label_parts[thread] > 1u) atomicOr(known.doubts[thread], doubt_one);
  uint chosen = head[thread];
  if (thread < count) {
    const uint label = group_label[chosen];
    if (label != known_none && label_parts[label] > 1u && !may_part(known.fingers[label], push.elapsed_us)) {
      chosen = label_part[label];
    }
  }
  regroup(chosen, count);
}

// Each sample of a known finger goes to the part of most of that finger's samples, if there is only one.
void return_home(uint count) {
  const uint thread = gl_LocalInvocationIndex;
  label_parts[thread] = 0u;
  label_part[thread] = most;
  barrier();
  if (thread < count && head[thread] == thread) {
    const uint label = label_of(thread);
    if (label != known_none) {
      atomicAdd(label_parts[label], 1u);
      atomicMin(label_part[label], thread);
    }
  }
  barrier();
  const uint label = labels_of[thread];
  uint chosen = head[thread];
  if (label != known_none) chosen = label_parts[label] == 1u ? label_part[label] : chosen;
  regroup(chosen, count);
}

// The links between groups, for valleys alone.
void link_groups(uint count) {
  const uint thread = gl_LocalInvocationIndex;
  const uvec2 tells = looked_of(thread), says_two = valley_of(thread);
  for (uint s = 0u; s < count; ++s) links[thread * most + s] = (holds(says_two, s) ? 65536u : 0u) + (holds(tells, s) ? 1u : 0u);
  barrier();
  for (uint s = 0u; s < count; ++s) {
    if (head[s] != s) links[head[s] * most + thread] += links[s * most + thread];
  }
  barrier();
  for (uint s = 0u; s < count; ++s) {
    if (head[s] != s) links[thread * most + head[s]] += links[thread * most + s];
  }
  barrier();
}

// Joins parts between which no valley is seen, or whose insides are one: the nearest first.
void settle(uint count) {
  const uint thread = gl_LocalInvocationIndex;
  link_groups(count);
  for (uint round = 1u; round < count; ++round) {
    if (thread < count && head[thread] == thread) {
      Float3 sum = Float3(0.0, 0.0, 0.0);
      for (uvec2 left = members[thread]; left != uvec2(0u); left = without_first(left)) {
        sum = plus(sum, minus(insides[first_of(left)], insides[0]));
      }
      means[thread] = scaled(sum, 1.0 / float(size_of(members[thread])));
      group_label[thread] = label_of(thread);
    }
    barrier();
    uint found = fingers_nothing;
    float found_square = 0.0;
    if (thread < count && head[thread] == thread) {
      for (uint b = thread + 1u; b < count; ++b) {
        if (head[b] != b) continue;
        const float square = square_apart(means[thread], means[b]);
        const bool apart = were_apart(thread, b);
        if (are_fingers(link_between(thread, b), square, push.finger_width, apart)) continue;
        if (apart && !may_be_one(thread, b)) continue;
        if (found != fingers_nothing && square >= found_square) continue;
        found = b;
        found_square = square;
      }
    }
    best[thread] = found;
    best_square[thread] = found_square;
    barrier();
    if (thread == 0u) {
      uint a = fingers_nothing;
      for (uint s = 0u; s < count; ++s) {
        if (best[s] != fingers_nothing && (a == fingers_nothing || best_square[s] < best_square[a])) a = s;
      }
      joined = a;
    }
    barrier();
    if (joined == fingers_nothing) break;  // the whole group
    join();
  }
  barrier();
}

void main() {
  const uint thread = gl_LocalInvocationIndex;
  const uint finger = gl_WorkGroupID.x;
  if (states[finger].kind != split_wide) return;  // the whole group
  const uint count = min(states[finger].samples, most);
  if (thread < count) {
    const BridgeSample s = samples[finger * bridge_samples + thread];
    places[thread] = Float3(s.x, s.y, s.z);
    normals[thread] = Float3(s.normal_x, s.normal_y, s.normal_z);
    insides[thread] = inside_of(places[thread], normals[thread], push.finger_width);
  }
  labels_of[thread] = thread < count ? samples[finger * bridge_samples + thread].known : known_none;
  if (thread == 0u) known_low = known_high = 0u;
  head[thread] = thread;
  members[thread] = thread < count ? only(thread) : uvec2(0u);
  barrier();

  if (thread < count) {
    uvec2 tells = looked_of(thread), says_two = valley_of(thread), one = uvec2(0u), relatives = uvec2(0u);
    const uint label = labels_of[thread];
    for (uint s = 0u; s < count; ++s) {
      if (label != known_none && labels_of[s] == label) relatives |= only(s);
      if (s == thread) continue;
      const bool strangers = label != known_none && labels_of[s] != known_none && labels_of[s] != label;
      const uint a = min(s, thread), b = max(s, thread);
      if (one_inside(insides[a], insides[b], push.finger_width)) {
        one |= only(s);
        tells |= only(s);
        says_two &= ~only(s);
      } else if (strangers || face_each_other(places[a], normals[a], places[b], normals[b])) {
        tells |= only(s);
        says_two |= only(s);
      }
    }
    for (uint s = 0u; s < count; ++s) links[thread * most + s] = (holds(says_two, s) ? 65536u : 0u) + (holds(tells, s) ? 1u : 0u);
    same[thread] = one;
    kin[thread] = relatives;
  }
  barrier();
  grow(count);
  for (uint round = 0u; round < split_votes; ++round) vote(count);
  settle(count);
  hold(count);
  return_home(count);

  if (thread < count) labels[finger * bridge_samples + thread] = head[thread];
  if (thread < count && head[thread] == thread && label_of(thread) != known_none) {
    atomicOr(known_low, only(thread).x);
    atomicOr(known_high, only(thread).y);
  }
  barrier();
  clusters[push.most_contacts + finger * split_numbers + thread] = Cluster(fingers_nothing, 0u);
  if (thread == 0u) {
    uvec2 parts = uvec2(0u);
    for (uint s = 0u; s < count; ++s) parts |= only(head[s]);
    states[finger].kind = size_of(parts) > 1u ? split_several : split_stays;
    states[finger].parts_low = parts.x;
    states[finger].parts_high = parts.y;
    states[finger].known_low = known_low;
    states[finger].known_high = known_high;
  }
}
