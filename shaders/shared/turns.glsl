// Sines and cosines of phases in turns.
#include "shaders/shared/sine_of_turns.h"

// Cosine and sine of an angle in turns, -1/2..1/2.
vec2 unit_of_part(float part) {
  const float size = abs(part);
  const float sine = sine_of_turns(0.25 - abs(0.25 - size));
  return vec2(sine_of_turns(0.25 - size), part < 0.0 ? -sine : sine);
}
// The same for any number of turns.
vec2 unit_of_turns(float turns) { return unit_of_part(turns - floor(turns + 0.5)); }

vec2 times(vec2 a, vec2 b) { return vec2(a.x * b.x - a.y * b.y, a.x * b.y + a.y * b.x); }
