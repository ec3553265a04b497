#include "study/tables/measures.hpp"

#include <cstdint>

#include "study/statistics/proportions.hpp"
#include "study/statistics/special.hpp"
#include "study/tables/dprime.hpp"

namespace palpa::study {

Measures measure(const std::string& name, const Confusion& table) {
  Measures all{.name = name, .table = table, .accuracy = accuracy(table)};
  const std::uint64_t trials = table.total(), correct = table.correct();
  all.clopper_pearson = clopper_pearson(correct, trials);
  all.p_chance = binomial_tail(correct, trials, 1 / static_cast<double>(table.size()));
  all.dprime = dprime(correct, trials, static_cast<std::uint32_t>(table.size()));
  for (std::size_t a = 0; a < table.size(); ++a) {
    for (std::size_t b = a + 1; b < table.size(); ++b)
      all.pairs.push_back({a, b, dprime_of_pair(table, a, b)});
  }
  all.luce_fit = luce_fit(table);
  all.information = information(table);
  return all;
}

}  // namespace palpa::study
