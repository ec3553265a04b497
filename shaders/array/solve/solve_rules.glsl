// The rules of gs_pat.hpp.

// What part of full loudness a focus may claim, by what it gives at its own place alone.
float claim_of(float alone, float loudest) { return loudest > 0.0 ? min(solve_most_help * alone / loudest, 1.0) : 1.0; }

// The phase of `p`, or of `otherwise` where p has none, at magnitude `size`.
vec2 turned(float size, vec2 p, vec2 otherwise) {
  const float loud = length(p);
  if (loud > 0.0) return p * (size / loud);
  const float other = length(otherwise);
  return other > 0.0 ? otherwise * (size / other) : vec2(size, 0.0);
}

// By what a factor grows whose focus is to be as loud as `aim` and is `heard`. No more than four times per step: a
// pressure near zero says little.
float growth(float aim, float heard) { return aim < 4.0 * heard ? aim / heard : 4.0; }

// What a transducer does of `sum` under `uniform` and `clamp`.
vec2 bounded(vec2 sum) {
  const float size = length(sum);
  return size > 0.0 && (push.constraint == drive_uniform || size > 1.0) ? sum / size : sum;
}
