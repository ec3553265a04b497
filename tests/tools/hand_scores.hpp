// What palpa makes of a hand of hand_rates, beside what is true.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "hand_classes.hpp"
#include "touch/stage_setting.hpp"

namespace palpa::test {

/// The figures of one hand, or of all hands of a class. hand_rates.cpp says what they mean.
struct HandScore {
  std::size_t frames = 0, right = 0, fair = 0;
  int events = 0, changes = 0, swaps = 0;
  int touches = 0, true_touches = 0, presses = 0, true_presses = 0;
  std::size_t finger_frames = 0, silent = 0;
  std::vector<double> jumps_m, deeper_m, first_s, second_s, leaves_s, ahead_m;

  void add(const HandScore& other);
  /// How bad a hand is beside others of its class.
  double badness() const;
};

/// The value that this share of the values does not exceed; 0 without values.
double quantile(std::vector<double> values, double share);

HandScore score_of(const RatedHand& hand, const touch::HysteresisRules& rules);

}  // namespace palpa::test
