// Whether and how far foci are predicted, as plain values.
#pragma once

#include <cstdint>
#include <optional>

#include "base/words.hpp"

namespace palpa::session {

enum class Predict {
  off,
  automatic,  ///< by the latency that is measured, or by a fixed one
};
inline constexpr Word<Predict> predict_words[] = {{"off", Predict::off}, {"auto", Predict::automatic}};

struct PredictOptions {
  Predict predict = Predict::off;
  /// From a frame's capture to the middle of the first slot that plays it, instead of the measured one. If the frame's
  /// slots are not known either, as in a loop in which frames wait, foci are predicted for the middle of their cycle.
  std::optional<double> latency_s;
};

/// No finger is predicted for longer after its capture. Foci of later slots stay where they are at this time, until the
/// hold ends.
inline constexpr double most_ahead_s = 60e-3;

/// Foci that would move less than this in most_ahead_s stand still, and their plan lists one cycle. It is far less than
/// a focus is wide (4 mm) and than any sensor's noise.
inline constexpr double least_way_m = 0.05e-3;

/// When a plan's first slot sounds, as far as that is known when the plan is made.
struct FirstSlot {
  std::uint64_t slot = 0;
  std::optional<double> ahead_s;  ///< measured: from the frame's capture to the middle of that slot
};

/// The result of a frame's prediction.
struct Prediction {
  double latency_s = 0;   ///< from the frame's capture to the middle of the first slot that may play it
  double distance_m = 0;  ///< the farthest way of a finger until the time for which its foci were sought
  bool clamped = false;   ///< some slot of the first cycle comes later than most_ahead_s
};

}  // namespace palpa::session
