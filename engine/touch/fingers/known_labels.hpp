// Which finger of the frame before a place on the skin belongs to. The steps that split and join clusters ask for
// it, so that a finger stays what it is until the evidence against it is strong.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "touch/fingers/known.hpp"
#include "touch/fingers/sight.hpp"

namespace palpa::touch {

/// The fingers of the frame before, as the steps of a frame see them.
struct Known {
  std::uint32_t elapsed_us = 0;   ///< from the frame before to this one
  HysteresisRules rules{};        ///< set even if `table` is null
  KnownFingers* table = nullptr;  ///< null: there are none; only their doubts change before admit_fingers()
  float finger_width = 0;         ///< metres

  bool may_part(std::uint32_t finger) const { return touch::may_part(table->fingers[finger].continuation, elapsed_us); }
  bool may_meet(std::uint32_t finger) const { return touch::may_meet(table->fingers[finger].continuation, elapsed_us); }
  void doubt(std::uint32_t finger, const Doubt& what) const { table->fingers[finger].doubt.add(what); }
};

/// For each sample of skin in a solid, the known finger whose inside is nearest to the sample's, within
/// known_reach finger widths. Known fingers move on with their velocities.
using KnownLabels = InplaceVector<WhichKnown, most_samples>;
KnownLabels known_labels(const Known& known, std::uint32_t solid, const SkinSamples& samples);

/// The same for a cluster without samples, from the place of its first contact.
WhichKnown known_at(const Known& known, std::uint32_t solid, const glm::vec3& place);

/// The known finger that most of the samples belong to, if they are at least half of all. If two have equally many, it
/// is the first.
WhichKnown known_majority(std::span<const WhichKnown> labels);

/// The known finger of the solid whose inside is nearest to one of the samples', within a finger width.
WhichKnown known_nearby(const Known& known, std::uint32_t solid, std::span<const SkinSample> samples);

/// What a frame shows of a finger, or of a cluster that may be one. Found once, and again if its contacts change.
struct FingerSkin {
  SkinSamples samples;
  KnownLabels labels;  ///< known_labels()
  WhichKnown known{};  ///< known_majority()
};
FingerSkin look_at(const Sight& sight, const Known& known, const Touch& touch, const Finger& finger);

/// One for each finger of a touch; room for max_fingers.
using FingerSkins = std::vector<FingerSkin>;

}  // namespace palpa::touch
