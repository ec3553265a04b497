// How many participants a study needs, by simulating studies.
//
// A simulated participant has an accuracy of their own for each of two methods: the mean of the method plus a normal
// deviation, kept within 0 and 1. The deviations of one participant are correlated. The correct answers are binomial.
// Wilcoxon's exact signed-rank test then compares the methods, as in the analysis.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "study/statistics/moments.hpp"

namespace palpa::study {

/// The paper's correlation of ten people's accuracies, and the ends of its 95 % interval (Fisher).
inline constexpr double paper_correlation = 0.77, paper_correlation_low = 0.27, paper_correlation_high = 0.94;

struct PowerSetting {
  double a = 0.39, b = 0.6525;  ///< mean accuracies of the two methods; the default is the paper's
  double spread = 0.1;          ///< standard deviation between participants, without the noise of their trials
  double correlation = paper_correlation;  ///< of a participant's deviations with both methods, the paper's
  std::uint32_t trials = 40;               ///< of each participant with each method
  double alpha = 0.05;                     ///< a study finds an effect if the two-sided p is at most this
  double power = 0.8;                      ///< wanted: the share of studies that find the effect
  std::uint32_t studies = 2000;            ///< simulated for each number of participants
  std::uint32_t most_people = 200;         ///< no larger study is tried
  std::uint64_t seed = 0;
};
inline constexpr std::uint32_t most_simulated_people = 200;
/// Studies times people times trials, at most.
inline constexpr std::uint64_t most_simulated_trials = 400'000'000;

/// The mean accuracy of simulated participants. It differs from the method's mean if deviations beyond 0 or 1 are cut
/// off.
double mean_within_bounds(double mean, double spread);

struct PowerRow {
  std::uint32_t people = 0;
  std::uint32_t found = 0;  ///< studies that find the effect
  double power = 0;
  Interval interval{};  ///< 95 %, of the number of simulated studies
};

struct PowerResult {
  std::vector<PowerRow> rows{};           ///< that were simulated, by people
  std::optional<std::uint32_t> people{};  ///< the least that reach the wanted power; empty if most_people do not
};

/// The people that are needed if the correlation is another one.
struct OtherCorrelation {
  double correlation = 0;
  std::optional<std::uint32_t> people{};
};
/// For the ends of that interval, if the setting has the paper's correlation; otherwise nothing.
std::vector<OtherCorrelation> at_other_correlations(const PowerSetting& setting);

/// The numbers of participants that are tried are those from 2 to 20, then steps up to most_people, and all that a
/// bisection between two steps needs. Larger studies contain the participants of smaller ones.
PowerResult find_power(const PowerSetting& setting);

}  // namespace palpa::study
