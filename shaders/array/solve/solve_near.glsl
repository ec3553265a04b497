// The coupling between the foci of a slot, read from its matrix: gs_pat.hpp.

uint focus_base;   // where the slot's matrix begins
uint focus_first;  // its first focus
uint focus_count;  // its number of foci

vec2 at(uint row, uint column) { return matrices[focus_base + column * focus_count + row]; }

// The sound that a focus alone gives at its own place.
float alone(uint j) { return max(at(j, j).x, 0.0); }
float loudest_alone() {
  float loudest = 0.0;
  for (uint j = 0u; j < focus_count; ++j) loudest = max(loudest, alone(j));
  return loudest;
}

// The part of the sound of focus `k` that is heard at focus `j`.
float heard_part(uint j, uint k) {
  const float both = alone(j) * alone(k);
  return both > 0.0 ? min(length(at(j, k)) * inversesqrt(both), 1.0) : 0.0;
}

bool hear_each_other() {
  float nearest = 0.0;
  for (uint j = 1u; j < focus_count; ++j) {
    for (uint k = 0u; k < j; ++k) nearest = max(nearest, heard_part(j, k));
  }
  return nearest >= solve_hears;
}

// The target loudness of a focus: its gain times its claim, but at least the loudness that a coinciding focus gives it.
float target_of(uint j, float loudest) {
  float gain = gain_of(focus_first + j);
  for (uint k = 0u; k < focus_count; ++k) {
    if (k != j)
      gain = max(gain, gain_of(focus_first + k) * clamp((heard_part(j, k) - solve_same) / (1.0 - solve_same), 0.0, 1.0));
  }
  return gain * claim_of(alone(j), loudest);
}
