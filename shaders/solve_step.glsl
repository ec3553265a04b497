// One step of gs_pat.hpp by a workgroup: factors towards t_j L. All threads call these together.

shared vec2 factor[solve_most_foci];
shared vec2 field[solve_most_foci];    // what they give
shared float wanted[solve_most_foci];  // t_j
// What a focus that is hard to reach may have more than the others: gs_pat_most_help.
const float most_help = 4.0;
shared float moved[solve_most_foci];
shared float level;  // L
shared float scale;  // of the new magnitudes
shared bool still;
shared bool halfway;  // weights go half the way

// The phase of `p`, or of `otherwise` where p has none, at magnitude `size`.
vec2 turned(float size, vec2 p, vec2 otherwise) {
  const float most = length(p);
  if (most > 0.0) return p * (size / most);
  const float other = length(otherwise);
  return other > 0.0 ? otherwise * (size / other) : vec2(size, 0.0);
}

// No more than four times per step: a pressure near zero says little.
float new_size(uint j) {
  const float heard = length(field[j]);
  const float aim = wanted[j] * level;
  const float ratio = aim < 4.0 * heard ? aim / heard : 4.0;
  return length(factor[j]) * (halfway ? sqrt(ratio) : ratio);
}

// After a barrier behind whoever wrote `field`. `free`: the level is what they give now; `sum` is what the magnitudes
// add up to afterwards, 0: as it comes. Sets `still` and leaves the factors where the step before moved none of them.
void step_factors(uint count, bool free, float sum) {
  const uint thread = gl_LocalInvocationIndex;
  if (thread == 0u) {
    float farthest = 0.0;
    float heard = 0.0;
    float asked = 0.0;
    for (uint j = 0u; j < count; ++j) {
      farthest = max(farthest, moved[j]);
      heard += length(field[j]);
      asked += wanted[j];
    }
    still = farthest < push.still;
    if (free) level = asked > 0.0 ? heard / asked : 0.0;
    float total = 0.0;
    for (uint j = 0u; j < count; ++j) total += new_size(j);
    scale = sum > 0.0 && total > 0.0 ? sum / total : 1.0;
  }
  barrier();
  if (!still) {
    for (uint j = thread; j < count; j += solve_group) {
      const vec2 next = turned(min(new_size(j) * scale, push.most_weight), field[j], factor[j]);
      moved[j] = length(next - factor[j]);
      factor[j] = next;
    }
  }
  barrier();
}

// What each focus gives at its own place alone: the matrix' diagonal.
float alone(uint base, uint count, uint j) { return max(matrices[base + j * count + j].x, 0.0); }
float loudest_alone(uint base, uint count) {
  float most = 0.0;
  for (uint j = 0u; j < count; ++j) most = max(most, alone(base, count, j));
  return most;
}
// What part of full loudness a focus is to have at most.
float reach_of(float alone, float loudest) { return loudest > 0.0 ? min(most_help * alone / loudest, 1.0) : 1.0; }

void forget_moves(uint count) {
  for (uint j = gl_LocalInvocationIndex; j < count; j += solve_group) moved[j] = 1e30;
}
