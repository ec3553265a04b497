#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "shaders/array/solve/solve_inputs.glsl"

// Few foci under `uniform` and `clamp`. The start is the sums of the heard factors with the constraint applied. From
// there, transducers turn until the foci are even (even_phases.hpp). There is one workgroup per slot; a thread handles
// one transducer and all foci at a time. The angle of each transducer, in turns, is kept in its drive: the accepted one
// in the amplitude, the tried one in the phase. At the end, the phase holds the accepted one.
layout(local_size_x = 16) in;

layout(std430, set = 0, binding = 5) readonly buffer Matrices { vec2 matrices[]; };
layout(std430, set = 0, binding = 6) readonly buffer Weights { vec4 weights[]; };
layout(std430, set = 0, binding = 7) buffer Drives { DriveOut drives[]; };

#include "shaders/array/solve/solve_rules.glsl"
#include "shaders/array/solve/solve_near.glsl"

const uint pairs = most * (most + 1u) / 2u;  // of foci j and k <= j, at j * (j + 1) / 2 + k
const uint sums = most + pairs;

shared vec2 partial[sums * solve_phases_group];
shared vec2 tried[sums];     // the sums at the foci, then C
shared vec2 holds[sums];     // the same for the accepted angles
shared vec2 alike[pairs];    // A
shared vec2 pull[most];      // y_j u_j* divided by the amplitude that focus j is to have
shared float wanted[most];   // t_j
shared float normal[most * most];
shared float rest[most];

// Sums of partial[entry * solve_phases_group + thread] over the threads, in their order.
vec2 total_of(uint entry) {
  vec2 total = vec2(0.0);
  for (uint t = 0u; t < solve_phases_group; ++t) total += partial[entry * solve_phases_group + t];
  return total;
}
void total_tried(vec2 sum[sums]) {
  const uint thread = gl_LocalInvocationIndex;
  [[unroll]] for (uint e = 0u; e < sums; ++e) partial[e * solve_phases_group + thread] = sum[e];
  barrier();
  for (uint e = thread; e < sums; e += solve_phases_group) tried[e] = total_of(e);
  barrier();
}

// A transducer's drive before it turns, and its part that arrives at each focus.
vec2 unturned_of(uint n, Place places[most], vec2 by[most], out vec2 gives[most]) {
  const Source source = source_of(n);
  vec2 asks = vec2(0.0);
  [[unroll]] for (uint j = 0u; j < most; ++j) {
    const Pair pair = pair_of(source, places[j]);
    asks += times(by[j], vec2(pair.asked * pair.unit.x, -(pair.asked * pair.unit.y)));
    gives[j] = pair.unit * pair.loud;
  }
  return bounded(asks);
}

// Sums the sound at the foci before transducers turn, and A.
void begin(Place places[most], vec2 by[most], uint base) {
  const uint thread = gl_LocalInvocationIndex;
  vec2 sum[sums];
  vec2 like[pairs];
  [[unroll]] for (uint e = 0u; e < sums; ++e) sum[e] = vec2(0.0);
  [[unroll]] for (uint e = 0u; e < pairs; ++e) like[e] = vec2(0.0);
  for (uint n = thread; n < push.transducers; n += solve_phases_group) {
    vec2 gives[most];
    const vec2 drive = unturned_of(n, places, by, gives);
    drives[base + n] = DriveOut(0.0, 0.0);
    [[unroll]] for (uint j = 0u; j < most; ++j) {
      gives[j] = times(gives[j], drive);
      sum[j] += gives[j];
      [[unroll]] for (uint k = 0u; k <= j; ++k) {
        const uint e = j * (j + 1u) / 2u + k;
        sum[most + e] += times(gives[j], gives[k]);
        like[e] += times(gives[j], vec2(gives[k].x, -gives[k].y));
      }
    }
  }
  total_tried(sum);
  [[unroll]] for (uint e = 0u; e < pairs; ++e) partial[e * solve_phases_group + thread] = like[e];
  barrier();
  for (uint e = thread; e < pairs; e += solve_phases_group) alike[e] = total_of(e);
  barrier();
}

// Turns the transducers by the pull and sums the sound at the foci then. `kept`: the angles tried before are accepted.
void walk(Place places[most], vec2 by[most], uint base, bool kept) {
  const uint thread = gl_LocalInvocationIndex;
  vec2 pulls[most];
  vec2 sum[sums];
  [[unroll]] for (uint j = 0u; j < most; ++j) pulls[j] = j < focus_count ? pull[j] : vec2(0.0);
  [[unroll]] for (uint e = 0u; e < sums; ++e) sum[e] = vec2(0.0);
  for (uint n = thread; n < push.transducers; n += solve_phases_group) {
    const DriveOut before = drives[base + n];
    const float held = kept ? before.phase : before.amplitude;
    vec2 gives[most];
    const vec2 unturned = unturned_of(n, places, by, gives);
    vec2 pulled = vec2(0.0);
    [[unroll]] for (uint j = 0u; j < most; ++j) pulled += times(pulls[j], gives[j]);
    const vec2 drive = times(unturned, unit_of_turns(held));
    const float turned = -(pulled.x * drive.y + pulled.y * drive.x) * 0.15915494;
    drives[base + n] = DriveOut(held, held + turned);
    const vec2 then = times(drive, unit_of_turns(turned));
    [[unroll]] for (uint j = 0u; j < most; ++j) {
      gives[j] = times(gives[j], then);
      sum[j] += gives[j];
      [[unroll]] for (uint k = 0u; k <= j; ++k) sum[most + j * (j + 1u) / 2u + k] += times(gives[j], gives[k]);
    }
  }
  total_tried(sum);
}

// The pull of the next step. Its aim is that each focus is louder than its target by `more` of the level.
void find_pull(float level, float more, float damping) {
  const uint thread = gl_LocalInvocationIndex;
  const uint count = focus_count;
  if (thread < count) {
    const float heard = length(holds[thread]);
    const float asked = wanted[thread] * level;
    pull[thread] = heard > 0.0 && asked > 0.0 ? vec2(holds[thread].x, -holds[thread].y) / (heard * asked) : vec2(0.0);
    rest[thread] = asked > 0.0 ? 1.0 - heard / asked + more : 0.0;
  }
  barrier();
  for (uint e = thread; e < count * count; e += solve_phases_group) {
    const uint a = max(e / count, e % count);
    const uint b = min(e / count, e % count);
    const uint pair = a * (a + 1u) / 2u + b;
    const vec2 turns = times(pull[a], vec2(pull[b].x, -pull[b].y));
    const vec2 twice = times(pull[a], pull[b]);
    normal[e] = 0.5 * (times(turns, alike[pair]).x - times(twice, holds[most + pair]).x);
  }
  barrier();
  float trace = 0.0;
  for (uint a = 0u; a < count; ++a) trace += normal[a * count + a];
  barrier();
  if (thread < count) normal[thread * count + thread] += max(damping * trace / float(count), 1e-30);
  barrier();
  for (uint k = 0u; k + 1u < count; ++k) {
    if (thread > k && thread < count) {
      const float part = normal[thread * count + k] / normal[k * count + k];
      for (uint j = k + 1u; j < count; ++j) normal[thread * count + j] -= part * normal[k * count + j];
      rest[thread] -= part * rest[k];
    }
    barrier();
  }
  for (uint left = count; left > 0u; --left) {
    const uint k = left - 1u;
    const float found = rest[k] / normal[k * count + k];
    if (thread < k) rest[thread] -= normal[thread * count + k] * found;
    if (thread == k) pull[k] *= found;
    barrier();
  }
}

void main() {
  const DriveSlot slot = slot_at(gl_WorkGroupID.x);
  if (!solves(slot)) return;
  focus_base = slot.solved;
  focus_first = slot.first;
  focus_count = slot.count;
  const uint thread = gl_LocalInvocationIndex;
  const uint count = slot.count;
  const uint base = gl_WorkGroupID.x * push.transducers;
  Place places[most];
  vec2 by[most];  // the heard factors
  [[unroll]] for (uint j = 0u; j < most; ++j) {
    const uint focus = slot.first + min(j, count - 1u);
    places[j] = place_of(focus);
    by[j] = j < count ? weights[focus].zw : vec2(0.0);
  }
  const float loudest = loudest_alone();
  if (thread < count) wanted[thread] = target_of(thread, loudest);
  barrier();

  uint raises = 0u;
  uint made = 0u;
  bool first = true;
  bool kept = false;
  float damping = solve_damping;
  float missed = 0.0;
  float worst = 0.0;
  float weakest = 0.0;
  float level = 0.0;
  begin(places, by, base);
  for (uint turn = 0u; turn < 4096u; ++turn) {
    // All threads compute the same.
    float loud = 0.0;
    float asked = 0.0;
    for (uint j = 0u; j < count; ++j) {
      loud += length(tried[j]);
      asked += wanted[j];
    }
    const float level_then = asked > 0.0 ? loud / asked : 0.0;
    float missed_then = 0.0;
    float worst_then = 0.0;
    float weakest_then = -1.0;
    for (uint j = 0u; j < count; ++j) {
      const float wants = wanted[j] * level_then;
      const float lacks = wants > 0.0 ? 1.0 - length(tried[j]) / wants : 0.0;
      missed_then += lacks * lacks;
      worst_then = max(worst_then, abs(lacks));
      const float heard = wanted[j] > 0.0 ? length(tried[j]) / wanted[j] : weakest_then;
      weakest_then = weakest_then < 0.0 ? heard : min(weakest_then, heard);
    }
    kept = first || (raises > 0u ? weakest_then > weakest
                                 : missed_then < missed && weakest_then >= solve_keep * weakest);
    if (kept) {
      missed = missed_then;
      worst = worst_then;
      weakest = weakest_then;
      level = level_then;
      for (uint e = thread; e < sums; e += solve_phases_group) holds[e] = tried[e];
    }
    barrier();
    if (first) {
      if (worst <= solve_miss) break;
      raises = worst > solve_uneven ? solve_raises : 0u;
      first = false;
    } else {
      damping = kept ? max(damping * solve_less, solve_least_damping) : damping * solve_more;
      ++made;
      if (raises > 0u) {
        --raises;
        if (raises == 0u) damping = solve_damping;
      }
    }
    if ((raises == 0u && worst <= solve_miss) || made >= push.tries || damping > solve_most_damping) break;
    find_pull(level, raises > 0u ? solve_push : 0.0, damping);
    walk(places, by, base, kept);
  }
  if (!kept) {
    for (uint n = thread; n < push.transducers; n += solve_phases_group)
      drives[base + n].phase = drives[base + n].amplitude;
  }
}
