// The delay of one transducer for one focus.

// The largest float that is not above pi: pi itself would round up.
const float float_pi = 3.1415925;

struct Path {
  float distance;  // wavelengths
  float turns;     // -k d as turns, wrapped to (-1/2, 1/2]
};

Path path(vec4 from_coarse, vec4 from_fine, vec4 to_coarse, vec4 to_fine) {
  precise const vec3 coarse = to_coarse.xyz - from_coarse.xyz;  // exact
  precise const vec3 fine = to_fine.xyz - from_fine.xyz;
  precise const vec3 way = coarse + fine;
  precise const float near = sqrt(way.x * way.x + way.y * way.y + way.z * way.z);
  // d^2 = a + b with a exact.
  precise const float a = coarse.x * coarse.x + coarse.y * coarse.y + coarse.z * coarse.z;
  precise const float b = fine.x * (2.0 * coarse.x + fine.x) + fine.y * (2.0 * coarse.y + fine.y) +
                          fine.z * (2.0 * coarse.z + fine.z);
  // d - whole = (d^2 - whole^2) / (d + whole) for any `whole`. The square of a multiple of 1/16 is exact, too.
  precise const float whole = floor(near * 16.0 + 0.5) * 0.0625;
  precise const float rest = whole > 0.0 ? ((a - whole * whole) + b) / (near + whole) : near;
  precise float turns = fract(whole) + rest;
  turns = floor(turns) - turns;
  if (turns <= -0.5) turns += 1.0;
  return Path(near, turns);
}

float phase_of(float turns) { return clamp(turns * 6.2831853, -float_pi, float_pi); }
