// The sound between one transducer and one focus, in single precision. Half a thousandth of a wavelength of error costs
// a factor nothing; the drives themselves are reckoned with more care (drive_phase.glsl).

layout(std430, set = 0, binding = solve_transducers) readonly buffer Transducers { DrivePoint transducers[]; };
layout(std430, set = 0, binding = solve_axes) readonly buffer Axes { vec4 axes[]; };
layout(std430, set = 0, binding = solve_foci) readonly buffer Foci { DriveFocus foci[]; };
layout(std430, set = 0, binding = solve_slots) readonly buffer Slots { DriveSlot slots[]; };
layout(std430, set = 0, binding = solve_directivity) readonly buffer Directivity { uint directivity[]; };
layout(push_constant) uniform Push { SolvePush push; };

struct Place {
  vec3 coarse;
  vec3 fine;
  float w;  // of the coarse part: a focus' 1 / reach
};
Place place_of(DriveFocus focus) { return Place(focus.coarse.xyz, focus.fine.xyz, focus.coarse.w); }

// sin(2 pi x) for x in -1/4..1/4, within 1e-7; polynomials, so that every device agrees.
float sine_of_turns(float x) {
  const float y = x * 6.2831853;
  const float s = y * y;
  float series = -2.5052108e-8;
  series = series * s + 2.7557319e-6;
  series = series * s - 1.9841270e-4;
  series = series * s + 8.3333333e-3;
  series = series * s - 1.6666667e-1;
  series = series * s + 1.0;
  return y * series;
}
// Of any number of turns.
vec2 unit_of_turns(float turns) {
  const float part = turns - floor(turns + 0.5);
  const float size = abs(part);
  const float sine = sine_of_turns(0.25 - abs(0.25 - size));
  return vec2(sine_of_turns(0.25 - size), part < 0.0 ? -sine : sine);
}

struct Pair {
  vec2 unit;    // e^{ikd}
  float loud;   // what of a full transducer arrives, times the wavelength
  float asked;  // the amplitude that the focus asks
};

Pair pair_of(vec3 coarse, vec3 fine, vec3 axis, Place focus) {
  const vec3 way = (focus.coarse - coarse) + (focus.fine - fine);
  const float distance = sqrt(way.x * way.x + way.y * way.y + way.z * way.z);
  const float inverse = 1.0 / max(distance, 1e-12);
  const float slant = distance > 0.0 ? (way.x * axis.x + way.y * axis.y + way.z * axis.z) * inverse : 1.0;
  const float at = clamp((slant + 1.0) * (0.5 * float(solve_directivity_steps)), 0.0, float(solve_directivity_steps));
  const uint step = min(uint(at), solve_directivity_steps - 1u);
  const vec2 ends = unpackUnorm2x16(directivity[step]);
  Pair pair;
  pair.unit = unit_of_turns(distance);
  pair.loud = mix(ends.x, ends.y, at - float(step)) * min(inverse, 1.0 / push.nearest);
  pair.asked = push.weighting != drive_by_distance || focus.w == 0.0 ? 1.0 : min(distance * focus.w, 1.0);
  return pair;
}

// Only what a focus asks: no directivity to look up.
vec2 ask_of(vec3 coarse, vec3 fine, Place focus) {
  const vec3 way = (focus.coarse - coarse) + (focus.fine - fine);
  const float distance = sqrt(way.x * way.x + way.y * way.y + way.z * way.z);
  const float asked = push.weighting != drive_by_distance || focus.w == 0.0 ? 1.0 : min(distance * focus.w, 1.0);
  const vec2 unit = unit_of_turns(distance);
  return vec2(asked * unit.x, -asked * unit.y);
}

vec2 times(vec2 a, vec2 b) { return vec2(a.x * b.x - a.y * b.y, a.x * b.y + a.y * b.x); }
