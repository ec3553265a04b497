#include "study/power.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <span>

#include "base/random.hpp"
#include "base/system/parallel.hpp"
#include "study/statistics/proportions.hpp"
#include "study/statistics/wilcoxon.hpp"

namespace palpa::study {
namespace {

/// The differences of correct answers of one simulated study's participants.
std::vector<double> simulated(const PowerSetting& setting, std::uint32_t study) {
  // A stream of its own for each study, so that the result does not depend on the order.
  Random random(setting.seed * 0x9e3779b97f4a7c15u + Random(study).next());
  const double rest = std::sqrt(std::max(0.0, 1 - setting.correlation * setting.correlation));
  std::vector<double> differences(setting.most_people);
  for (double& difference : differences) {
    const double first = random.normal(), second = setting.correlation * first + rest * random.normal();
    const double a = std::clamp(setting.a + setting.spread * first, 0.0, 1.0);
    const double b = std::clamp(setting.b + setting.spread * second, 0.0, 1.0);
    const double of_a = random.binomial(setting.trials, a), of_b = random.binomial(setting.trials, b);
    difference = of_b - of_a;
  }
  return differences;
}

class Simulation {
 public:
  explicit Simulation(const PowerSetting& setting) : setting_(setting), studies_(setting.studies) {
    parallel_chunks(studies_.size(), 16, [&](std::size_t, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        studies_[i] = simulated(setting_, static_cast<std::uint32_t>(i));
    });
  }

  /// Tests the first `people` participants of each study; adds the row unless it is there.
  double at(std::uint32_t people, std::vector<PowerRow>& rows) const {
    for (const PowerRow& row : rows) {
      if (row.people == people) return row.power;
    }
    std::vector<char> found(studies_.size(), 0);
    parallel_chunks(studies_.size(), 16, [&](std::size_t, std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        found[i] = finds(std::span(studies_[i]).first(people)) ? 1 : 0;
    });
    PowerRow row{.people = people};
    row.found = static_cast<std::uint32_t>(std::ranges::count(found, 1));
    row.power = static_cast<double>(row.found) / static_cast<double>(found.size());
    row.interval = clopper_pearson(row.found, found.size());
    rows.push_back(row);
    return row.power;
  }

 private:
  bool finds(std::span<const double> differences) const {
    const SignedRank test = wilcoxon(differences);
    return test.two_sided <= setting_.alpha;
  }

  const PowerSetting& setting_;
  std::vector<std::vector<double>> studies_;
};

}  // namespace

double mean_within_bounds(double mean, double spread) {
  if (spread <= 0) return mean;
  // What a normal variable loses on average if it is cut off `z` standard deviations above its mean.
  const auto cut = [](double z) {
    const double density = std::exp(-z * z / 2) / std::sqrt(2 * std::numbers::pi);
    return density - z * std::erfc(z / std::numbers::sqrt2) / 2;
  };
  return mean + spread * (cut(mean / spread) - cut((1 - mean) / spread));
}

PowerResult find_power(const PowerSetting& setting) {
  const Simulation simulation(setting);
  PowerResult result;
  constexpr std::uint32_t every = 20;
  std::uint32_t low = 1, high = 0;
  for (std::uint32_t people = std::min(2u, setting.most_people); people <= setting.most_people;) {
    if (simulation.at(people, result.rows) >= setting.power) {
      high = people;
      break;
    }
    low = people;
    if (people == setting.most_people) break;
    people = people < every ? people + 1 : people + std::max(1u, people / 4);
    people = std::min(people, setting.most_people);
  }
  while (high > low + 1) {
    const std::uint32_t middle = low + (high - low) / 2;
    (simulation.at(middle, result.rows) >= setting.power ? high : low) = middle;
  }
  if (high > 0) result.people = high;
  std::ranges::sort(result.rows, {}, &PowerRow::people);
  return result;
}

std::vector<OtherCorrelation> at_other_correlations(const PowerSetting& setting) {
  std::vector<OtherCorrelation> others;
  if (setting.correlation != paper_correlation) return others;
  for (const double correlation : {paper_correlation_low, paper_correlation_high}) {
    PowerSetting other = setting;
    other.correlation = correlation;
    others.push_back({correlation, find_power(other).people});
  }
  return others;
}

}  // namespace palpa::study
