// The free field: the sound between a transducer and a focus, recomputed wherever it is needed and never stored, in
// single precision. A factor tolerates an error of half a thousandth of a wavelength; the drives themselves are
// computed
// more precisely (drive_phase.glsl).
//
// The solvers' kernels use only these names of a transfer: Source, source_of, Place, place_of, Pair, pair_of, ask_of.

layout(set = 0, binding = 3) uniform samplerBuffer axes;
layout(set = 0, binding = 4) uniform usamplerBuffer directivity;

// A transducer.
struct Source {
  vec3 coarse;
  vec3 fine;
  vec3 axis;
};
Source source_of(uint n) {
  const DrivePoint point = transducer_at(n);
  return Source(point.coarse.xyz, point.fine.xyz, texelFetch(axes, int(n)).xyz);
}

// A focus.
struct Place {
  vec3 coarse;
  vec3 fine;
  float inverse_reach;
};
Place place_of(uint focus) {
  const DriveFocus at = focus_at(focus);
  return Place(at.coarse.xyz, at.fine.xyz, at.coarse.w);
}

struct Pair {
  vec2 unit;    // e^{ikd}
  float loud;   // amplitude that arrives from a transducer at full amplitude, times the wavelength
  float asked;  // the amplitude that the focus asks for
};

float asked_at(float distance, Place focus) {
  return push.weighting != drive_by_distance || focus.inverse_reach == 0.0 ? 1.0
                                                                            : min(distance * focus.inverse_reach, 1.0);
}

Pair pair_of(Source source, Place focus) {
  const vec3 way = (focus.coarse - source.coarse) + (focus.fine - source.fine);
  const float distance = sqrt(way.x * way.x + way.y * way.y + way.z * way.z);
  const float inverse = 1.0 / max(distance, 1e-12);
  const float slant =
      distance > 0.0 ? (way.x * source.axis.x + way.y * source.axis.y + way.z * source.axis.z) * inverse : 1.0;
  const float at = clamp((slant + 1.0) * (0.5 * float(solve_directivity_steps)), 0.0, float(solve_directivity_steps));
  const uint step = min(uint(at), solve_directivity_steps - 1u);
  const vec2 ends = unpackUnorm2x16(texelFetch(directivity, int(step)).x);
  return Pair(unit_of_turns(distance), mix(ends.x, ends.y, at - float(step)) * min(inverse, 1.0 / push.nearest),
              asked_at(distance, focus));
}

// Only the part that a focus asks for: needs no lookup of the directivity.
vec2 ask_of(Source source, Place focus) {
  const vec3 way = (focus.coarse - source.coarse) + (focus.fine - source.fine);
  const float distance = sqrt(way.x * way.x + way.y * way.y + way.z * way.z);
  const vec2 unit = unit_of_turns(distance);
  return asked_at(distance, focus) * vec2(unit.x, -unit.y);
}
