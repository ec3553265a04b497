// The rules of gs_pat.hpp.

// The phase of a focus in a sound that converges on the first transducer.
vec2 first_phase(uint focus) {
  const Pair first = pair_of(source_of(0u), place_of(focus));
  return vec2(first.unit.x, -first.unit.y);
}

// The part of full loudness that a focus may claim, from the sound that it alone gives at its own place.
float claim_of(float alone, float loudest) { return loudest > 0.0 ? min(solve_most_help * alone / loudest, 1.0) : 1.0; }

// The phase of `p`, or that of `otherwise` if p is 0, at magnitude `size`.
vec2 turned(float size, vec2 p, vec2 otherwise) {
  const float loud = length(p);
  if (loud > 0.0) return p * (size / loud);
  const float other = length(otherwise);
  return other > 0.0 ? otherwise * (size / other) : vec2(size, 0.0);
}

// The growth of the factor of a focus that is to be as loud as `aim` and is as loud as `heard`. It is at most 4 per
// step, because a pressure near zero says little.
float growth(float aim, float heard) { return aim < 4.0 * heard ? aim / heard : 4.0; }

// A transducer's drive for `sum` under `uniform` and `clamp`.
vec2 bounded(vec2 sum) {
  const float size = length(sum);
  return size > 0.0 && (push.constraint == drive_uniform || size > 1.0) ? sum / size : sum;
}
