// The parts of a wide cluster: which of its samples belong to one finger. The rules are in docs/touch.md.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "touch/fingers/known_labels.hpp"
#include "touch/fingers/sight.hpp"

namespace palpa::touch {

/// Each sample belongs to one part, which has the number of its first sample.
struct Parts {
  InplaceVector<std::uint8_t, most_samples> part;  ///< per sample
  std::array<glm::vec3, most_samples> insides{};   ///< per sample: inside_of()
  /// Per part: the known finger of most of its samples that belong to one.
  std::array<WhichKnown, most_samples> known{};
  std::array<Doubt, max_fingers> doubts{};  ///< per finger of the frame before

  bool several() const {
    return std::ranges::any_of(part, [](std::uint8_t p) { return p != 0; });
  }
};

/// `labels`: the samples' known fingers. Several threads may call it.
Parts find_parts(const Sight& sight, const SkinSamples& samples, float finger_width, const KnownLabels& labels,
                 const Known& known);

}  // namespace palpa::touch
