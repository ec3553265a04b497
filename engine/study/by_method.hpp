// What each participant answered with each method, and what all of them answered together.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "study/files/trial.hpp"
#include "study/statistics/moments.hpp"
#include "study/tables/measures.hpp"

namespace palpa::study {

/// One participant with one method.
struct PersonResult {
  std::size_t person = 0;  ///< place in Study::participants
  std::size_t method = 0;  ///< place in Study::methods
  std::uint32_t turn = 0;  ///< 1 for the method that the participant used first, 2 for the second, ...
  Confusion table{};
  std::uint32_t voids = 0;  ///< void trials
  double accuracy = 0;
  std::optional<double> dprime{};
  double bits = 0;                     ///< transmitted information; large for few trials
  std::optional<double> response_s{};  ///< median
};

/// All participants with one method.
struct MethodResult {
  Measures pooled{};                         ///< of all their trials
  std::vector<std::size_t> results{};        ///< places in Results::people
  std::uint32_t voids = 0;                   ///< void trials, also of people with other trials only
  std::vector<std::uint32_t> void_shapes{};  ///< the same by shape
  std::vector<double> accuracies{};          ///< one per participant, in the same order
  double mean_accuracy = 0;                  ///< each participant counts the same
  std::optional<double> deviation{};         ///< standard deviation between participants
  std::optional<Interval> t{}, bootstrap{};  ///< 95 % of the mean
};

struct Results {
  std::vector<PersonResult> people{};   ///< by participant, then method; only with trials
  std::vector<MethodResult> methods{};  ///< in the order of Study::methods
};
/// Every method of the study has trials.
Results results_by_method(const Study& study, std::uint64_t seed);

}  // namespace palpa::study
