#include "touch/fingers/known_labels.hpp"

#include <algorithm>
#include <array>

namespace palpa::touch {
namespace {

struct Nearest {
  WhichKnown finger{};
  float square = 0;
};

/// The known finger of the solid whose inside is nearest to `inside`, if it is within `reach`.
Nearest nearest_known(const Known& known, std::uint32_t solid, const glm::vec3& inside, float reach) {
  Nearest best{{}, reach * reach};
  const float elapsed_s = shader::seconds_of(known.elapsed_us);
  for (std::uint32_t k = 0; k < known.table->count; ++k) {
    const KnownFinger& finger = known.table->fingers[k];
    if (finger.solid != solid) continue;
    const glm::vec3 before = inside - finger.velocity * elapsed_s;
    if (square_between(before, before, finger.low, finger.high) >= best.square) continue;
    for (const glm::vec3& place : finger.insides) {
      const float square = square_apart(before, place);
      if (square < best.square) best = {k, square};
    }
  }
  return best;
}

Nearest nearest_known(const Known& known, std::uint32_t solid, const SkinSample& sample, float reach) {
  return nearest_known(known, solid, inside_of(sample, known.finger_width), reach);
}

float label_reach(const Known& known) {
  return known_reach * known.finger_width;
}

}  // namespace

KnownLabels known_labels(const Known& known, std::uint32_t solid, const SkinSamples& samples) {
  KnownLabels labels(samples.size(), {});
  if (known.table == nullptr) return labels;
  const float reach = label_reach(known);
  for (std::size_t s = 0; s < samples.size(); ++s)
    labels[s] = nearest_known(known, solid, samples[s], reach).finger;
  return labels;
}

WhichKnown known_at(const Known& known, std::uint32_t solid, const glm::vec3& place) {
  return known.table == nullptr ? WhichKnown{} : nearest_known(known, solid, place, label_reach(known)).finger;
}

WhichKnown known_majority(std::span<const WhichKnown> labels) {
  std::array<std::uint32_t, max_fingers> count{};
  for (const WhichKnown& label : labels) {
    if (label) ++count[*label];
  }
  const auto best = std::ranges::max_element(count);
  if (*best == 0 || std::size_t{2} * *best < labels.size()) return {};
  return static_cast<std::uint32_t>(best - count.begin());
}

WhichKnown known_nearby(const Known& known, std::uint32_t solid, std::span<const SkinSample> samples) {
  Nearest best{{}, 3.0e38F};
  if (known.table == nullptr) return best.finger;
  for (const SkinSample& sample : samples) {
    const Nearest here = nearest_known(known, solid, sample, known.finger_width);
    if (here.finger && here.square < best.square) best = here;
  }
  return best.finger;
}

FingerSkin look_at(const Sight& sight, const Known& known, const Touch& touch, const Finger& finger) {
  FingerSkin skin{.samples = sample_skin(sight, touch, finger)};
  skin.labels = known_labels(known, finger.solid, skin.samples);
  skin.known = known_majority(skin.labels);
  return skin;
}

}  // namespace palpa::touch
