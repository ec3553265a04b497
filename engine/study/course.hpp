// What changes over time: accuracy over the trials of a session, the time to answer, and the depth of the finger within
// a trial.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "study/by_method.hpp"
#include "study/statistics/wilcoxon.hpp"

namespace palpa::study {

/// The trials of a session in this many blocks of the same length.
inline constexpr std::size_t blocks = 4;

/// Accuracy over the trials with one method.
struct Learning {
  /// Mean over participants with at least one trial per block; empty if there is nobody.
  std::vector<double> block_accuracy{};
  std::vector<double> gains{};  ///< accuracy of the second half less that of the first, one per participant
  SignedRank test{};            ///< of `gains`
};

struct AnswerTimes {
  std::vector<double> medians{};      ///< one per participant with times
  std::optional<double> median_s{};   ///< of the medians
  std::optional<double> correct_s{};  ///< the same for trials that were answered correctly
  std::optional<double> wrong_s{};
};

/// The mean depth of the finger below the top of the object, over participants, by bin of DepthCourse.
struct MeanDepth {
  std::vector<std::optional<double>> depth_m{};  ///< no value where no participant has a sample
  std::size_t people = 0;
};

struct MethodCourse {
  Learning learning{};
  AnswerTimes times{};
  std::vector<MeanDepth> depths{};  ///< by shape; empty without recordings
};
/// In the order of Study::methods.
std::vector<MethodCourse> courses(const Study& study);

}  // namespace palpa::study
