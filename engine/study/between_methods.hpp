// Whether participants are better with one method than with another. All tests are over participants, because trials of
// one participant are not independent.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "study/by_method.hpp"
#include "study/statistics/paired.hpp"
#include "study/statistics/rank_tests.hpp"
#include "study/statistics/wilcoxon.hpp"
#include "study/tables/two_tables.hpp"

namespace palpa::study {

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
BetweenMethods between_methods(const Study& study, const Results& results, std::uint64_t seed);

}  // namespace palpa::study
