// All measures of one confusion matrix.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "study/statistics/moments.hpp"
#include "study/tables/confusion.hpp"
#include "study/tables/information.hpp"
#include "study/tables/luce.hpp"

namespace palpa::study {

struct PairDistance {
  std::size_t a = 0, b = 0;        ///< shapes, a < b
  std::optional<double> dprime{};  ///< see dprime_of_pair()
};

struct Measures {
  std::string name{};  ///< of the method or the file
  Confusion table{};
  double accuracy = 0;
  Interval clopper_pearson{};      ///< 95 %, as if all trials were independent
  double p_chance = 1;             ///< of at least as many correct answers by chance
  std::optional<double> dprime{};  ///< of m alternatives
  std::vector<PairDistance> pairs{};
  std::optional<LuceFit> luce_fit{};
  Information information{};
};
/// The table must have trials.
Measures measure(const std::string& name, const Confusion& table);

}  // namespace palpa::study
