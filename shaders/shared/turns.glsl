// Sines and cosines of phases in turns. They are polynomials, so that every device agrees; a device's own may differ by
// 2^-11.

#ifndef promised
#define promised(x) (x)  // tests define this to detect arguments outside the polynomial's range
#endif

// sin(2 pi x) for x in -1/4..1/4, within 1e-7.
float sine_of_turns(float x) {
  const float y = promised(x) * 6.2831853;
  const float s = y * y;
  float series = -2.5052108e-8;
  series = series * s + 2.7557319e-6;
  series = series * s - 1.9841270e-4;
  series = series * s + 8.3333333e-3;
  series = series * s - 1.6666667e-1;
  series = series * s + 1.0;
  return y * series;
}

// Cosine and sine of an angle in turns, -1/2..1/2.
vec2 unit_of_part(float part) {
  const float size = abs(part);
  const float sine = sine_of_turns(0.25 - abs(0.25 - size));
  return vec2(sine_of_turns(0.25 - size), part < 0.0 ? -sine : sine);
}
// The same for any number of turns.
vec2 unit_of_turns(float turns) { return unit_of_part(turns - floor(turns + 0.5)); }

vec2 times(vec2 a, vec2 b) { return vec2(a.x * b.x - a.y * b.y, a.x * b.y + a.y * b.x); }
