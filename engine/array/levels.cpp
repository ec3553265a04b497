#include "array/levels.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>
#include <vector>

namespace palpa::array {
namespace {

constexpr double hopeless = 1e12;
constexpr double last = 1e-6;  ///< weight of fingers without a request, to the power of level_yield

double cap_of(const Demand& demand) {
  return demand.takes <= hopeless ? std::min(1.0, 1 / demand.takes) : 0;
}

double weight_of(const Demand& demand) {
  if (!(demand.takes <= hopeless)) return 0;
  return std::pow((demand.asks ? 1 : last) / std::max(1.0, demand.takes), level_yield);
}

}  // namespace

void share_out(std::span<const Demand> demands, double budget, std::span<double> levels) {
  assert(demands.size() == levels.size());
  for (std::size_t f = 0; f < demands.size(); ++f)
    levels[f] = cap_of(demands[f]);
  // Fingers that take something, in the order in which they reach their maximum.
  std::vector<std::size_t> order;
  for (std::size_t f = 0; f < demands.size(); ++f) {
    if (demands[f].takes > 0 && levels[f] > 0) order.push_back(f);
  }
  const auto full_at = [&](std::size_t f) { return levels[f] / weight_of(demands[f]); };
  std::ranges::stable_sort(order, {}, full_at);
  std::vector<double> rate(order.size() + 1, 0);  // amplitude per u of the finger and those after it
  for (std::size_t i = order.size(); i-- > 0;)
    rate[i] = rate[i + 1] + demands[order[i]].takes * weight_of(demands[order[i]]);
  double left = budget;
  for (std::size_t i = 0; i < order.size(); ++i) {
    const double u = std::max(left, 0.0) / rate[i];
    if (u < full_at(order[i])) {
      for (std::size_t rest = i; rest < order.size(); ++rest)
        levels[order[rest]] = std::min(levels[order[rest]], u * weight_of(demands[order[rest]]));
      return;
    }
    left -= demands[order[i]].takes * levels[order[i]];
  }
}

}  // namespace palpa::array
