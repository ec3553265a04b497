// Which finger of the frame before a place on the skin belongs to. The includer needs the buffer `known` (KnownTable),
// push.elapsed_us and push.finger_width, and split_math.h and known_math.h.
struct NearestKnown {
  uint finger;  // or known_none
  float square;
};

// The known finger of the solid whose inside is nearest to `inside`, if it is within `reach`.
NearestKnown nearest_known(uint solid, Float3 inside, float reach) {
  NearestKnown best = NearestKnown(known_none, product(reach, reach));
  if (push.elapsed_us == known_restart) return best;
  const float elapsed_s = known_seconds(push.elapsed_us);
  const uint count = min(known.count, known_fingers);
  for (uint k = 0u; k < count; ++k) {
    if (known.fingers[k].solid != solid) continue;
    const Float3 before = moved_back(inside, known.fingers[k].velocity, elapsed_s);
    const uint first = k * known_samples;
    const uint end = first + min(known.fingers[k].samples, known_samples);
    for (uint s = first; s < end; ++s) {
      const vec4 there = known.insides[s];
      const float square = square_apart(before, Float3(there.x, there.y, there.z));
      if (square < best.square) best = NearestKnown(k, square);
    }
  }
  return best;
}

uint known_at(uint solid, Float3 inside) {
  return nearest_known(solid, inside, product(PALPA_KNOWN_REACH, push.finger_width)).finger;
}
uint known_label(uint solid, Float3 position, Float3 normal) {
  return known_at(solid, inside_of(position, normal, push.finger_width));
}

shared uint label_counts[known_fingers];
shared uint label_most;  // 256 times the number of samples, plus 255 less the known finger

// The known finger that most samples belong to, and at least half of all `count`; else known_none. For the whole group
// of 64; `label` is that of the thread's sample, or known_none.
uint known_majority(uint label, uint count) {
  const uint thread = gl_LocalInvocationIndex;
  label_counts[thread] = 0u;
  if (thread == 0u) label_most = 0u;
  barrier();
  if (label != known_none) atomicAdd(label_counts[label], 1u);
  barrier();
  atomicMax(label_most, 256u * label_counts[thread] + 255u - thread);
  barrier();
  const uint most_samples = label_most / 256u;
  return most_samples > 0u && 2u * most_samples >= count ? 255u - label_most % 256u : known_none;
}
