// The whole analysis of a study: read it (files/study_folder.hpp), analyse it, write reports of it (report/).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "study/by_method.hpp"
#include "study/files/trial.hpp"
#include "study/statistics/paired.hpp"
#include "study/statistics/rank_tests.hpp"
#include "study/statistics/wilcoxon.hpp"
#include "study/tables/two_tables.hpp"

namespace palpa::study {

// ---- what changes over time: accuracy over the trials of a session, the time to answer, and the depth of the finger
// within a trial

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

// ---- whether participants are better with one method than with another; all tests are over participants, because
// trials of one participant are not independent

/// Whether it matters which method came first: the differences of those who had a before b, and of the others.
struct OrderEffect {
  std::vector<double> a_first{}, b_first{};  ///< differences
  std::optional<RankSum> test{};             ///< only if there are people in both groups
};

/// The difference b - a of the accuracies of participants who used both methods. Who has fewer than Study::least_trials
/// with one of them is left out. If nobody is left, there are no values.
struct MethodPair {
  std::size_t a = 0, b = 0;           ///< places in Study::methods, a < b
  std::vector<std::size_t> people{};  ///< places in Study::participants
  std::vector<double> differences{};  ///< in the same order
  double mean = 0;
  std::optional<Interval> t{}, bootstrap{};  ///< 95 % of the mean
  std::optional<double> cohens_d{};          ///< d_z
  HodgesLehmann hodges_lehmann{};
  SignedRank drop{}, pratt{};    ///< Wilcoxon's test with both treatments of zeros
  std::optional<double> holm{};  ///< `drop`'s exact p, corrected for all pairs; only above two methods
  std::optional<Correlation> pearson{}, spearman{};
  OrderEffect order{};
  TwoTables tables{};  ///< of all trials
  /// Participants with too few trials, who are left out of all of the above but `tables`: places in
  /// Study::participants. If some of them used both methods: Wilcoxon's test and the mean with these.
  std::vector<std::size_t> excluded{};
  std::size_t people_with_excluded = 0;
  std::optional<SignedRank> with_excluded{};
  std::optional<double> mean_with_excluded{};
};

struct BetweenMethods {
  std::vector<MethodPair> pairs{};     ///< that at least one participant used
  std::optional<Friedman> friedman{};  ///< of the participants who used all methods; only above two methods
};

struct Analysis {
  Study study{};
  std::uint64_t seed = 0;  ///< of the bootstrap
  Results results{};
  BetweenMethods between{};
  std::vector<MethodCourse> courses{};
};
/// The study must have trials, as read_study() makes sure. The same study and seed give the same numbers.
Analysis analyse(Study study, std::uint64_t seed);

}  // namespace palpa::study
