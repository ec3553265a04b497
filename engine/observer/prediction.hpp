// What the ideal observer predicts for a study, from one measured accuracy of one method.
//
// The only number that is fitted is the internal noise: with it, the predicted accuracy of one method equals the
// measured one. Results of people do not enter anywhere else; comparison.hpp puts them beside the prediction.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "observer/decision.hpp"
#include "observer/responses.hpp"
#include "observer/variants.hpp"
#include "study/statistics/moments.hpp"

namespace palpa::observer {

/// The measured accuracy to which the noise is fitted.
struct FittedNumber {
  std::size_t method = 0;    ///< index into the responses' methods
  double accuracy = 0;       ///< above chance, below 1
  std::uint64_t trials = 0;  ///< on which it rests
};

/// The study that is predicted.
struct PredictedStudy {
  FittedNumber fitted;
  std::uint32_t observers = 10, trials_per_shape = 10;
  double touch_s = 10;  ///< of a trial, divided equally among the depths
  std::uint64_t seed = 0;
};

struct PredictedMethod {
  double accuracy = 0;
  /// The accuracies if the fitted number were at the ends of its 95 % interval (Clopper and Pearson); empty if no noise
  /// gives one of these.
  std::optional<study::Interval> fitted_interval;
  double error = 0;            ///< numerical standard error of `accuracy`
  std::vector<double> shares;  ///< of answers, by rows
};

struct PredictedVariant {
  std::string name, what;
  double sigma = 0;                      ///< the noise; 0: no noise gives the fitted number, and `methods` is empty
  std::vector<PredictedMethod> methods;  ///< in the order of the responses
};

struct PredictedLevel {
  Level level;
  PredictedVariant prediction;
};

/// A method's place by predicted accuracy.
struct RankedMethod {
  std::size_t method = 0;
  std::uint32_t rank = 1;    ///< equal for ties
  double accuracy = 0;       ///< of the reference
  double low = 0, high = 0;  ///< over the variants
  double to_best = 0;        ///< the reference's difference to the first of its rank's group
  double spread = 0;         ///< the standard deviation of that difference over the variants
};

struct Prediction {
  std::vector<std::string> shapes, methods;
  std::vector<double> depths_m;
  std::uint32_t placements = 0;
  PredictedStudy study;
  study::Interval fitted_interval;         ///< 95 % of the fitted number
  std::vector<PredictedVariant> variants;  ///< the first is the reference
  std::vector<PredictedLevel> levels;      ///< of the reference, fitted at each level
  double reference_force_n = 0;            ///< the crest of the single focus at the level of the reference
  std::optional<PredictedLevel> at_plan;   ///< the reference with its own noise, at the plan's level
  std::vector<PredictedVariant> nulls;     ///< models without afferents: lapses, equal distances
  std::vector<RankedMethod> ranking;       ///< best first
  /// By method: 95 % of the mean accuracies of simulated studies of this size, with the reference's shares.
  std::vector<study::Interval> studies;
};

struct ObserverOptions {
  bool keep = false;                    ///< whether decisions are kept between runs (kept_variants.hpp)
  std::size_t points = default_points;  ///< of noise (decision.hpp)
};

/// Throws failure if the reference cannot be fitted: its accuracy is lower even without noise. Reports its progress
/// (Activity).
Prediction predict(const Responses& responses, const PredictedStudy& study, const ObserverOptions& options = {});

}  // namespace palpa::observer
