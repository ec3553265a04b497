// The pressure on skin over time while a schedule plays: maps that follow one another in slots, and a modulation.
#pragma once

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "array/schedule.hpp"

namespace palpa::observer {

struct PressurePattern {
  std::vector<std::vector<float>> maps;  ///< Pa, per face of the sites; at the crest of the modulation
  std::vector<std::uint32_t> slots;      ///< the map of each slot of the cycle; empty: silence
  double slot_s = 1.5e-3;
  double modulation_hz = 0;  ///< 0: none
  array::Modulation modulation = array::Modulation::pressure_sine;

  /// After how many seconds it repeats: the cycle, or a period of the modulation if it has one slot only.
  double period_s() const;
};

/// The maps that sound in sample `n` of `rate_hz`, with the weight of each: the share of the sample that it lasts,
/// times the square of the modulation's gain in the middle of the sample. The modulation is continuous, unlike that of
/// drives, which holds for a slot.
std::vector<std::pair<std::uint32_t, double>> sounding(const PressurePattern& pattern, std::size_t n, double rate_hz);

}  // namespace palpa::observer
