// What a sweep will take, from the models (estimate.hpp) and from results that exist.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "setup/options.hpp"
#include "sweep/cases.hpp"

namespace palpa::sweep {

/// Times are those of one process that computes one case after the other.
struct Forecast {
  std::uint64_t cases = 0;
  double least_s = 0, median_s = 0, most_s = 0, all_s = 0;
  double most_bytes = 0;
  std::uint64_t measured = 0;  ///< results that the times are fitted to
  double factor = 1;           ///< of the measured times to the models': the median over these results
};

/// For `some` of all cases of the plan, with their costs, on that backend. `out`: a folder of results, or empty; those
/// of the same backend count. Throws as Store does.
Forecast forecast_of(const std::vector<Case>& all, const std::vector<Case>& some, const std::string& out,
                     setup::Backend backend);

}  // namespace palpa::sweep
