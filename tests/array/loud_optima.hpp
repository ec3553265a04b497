// The peak pressure in pascals that the weakest focus of each set of loud_sets.hpp can have with every amplitude at 1,
// as tests/tools/loud_optima.cpp found it. A few values may be a little too low: no search is certain.
#pragma once

#include <cctype>
#include <cstddef>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "support/shared_data.hpp"

namespace palpa::array {

struct LoudOptima {
  std::string layout;
  std::size_t fewest = 0, most = 0;  ///< foci of a set
  std::vector<double> pascals;       ///< set by set
};

/// Those of loud_optima.txt: lines with a layout, its fewest and most foci, and below each of them the numbers.
inline const std::vector<LoudOptima>& loud_optima() {
  static const std::vector<LoudOptima> all = [] {
    std::vector<LoudOptima> found;
    std::ifstream file(test::source_file("tests/array/loud_optima.txt"));
    for (std::string line; std::getline(file, line);) {
      std::istringstream words(line);
      if (std::isalpha(static_cast<unsigned char>(line[0])) != 0) {
        LoudOptima& next = found.emplace_back();
        words >> next.layout >> next.fewest >> next.most;
      } else {
        for (double pascals = 0; words >> pascals;)
          found.back().pascals.push_back(pascals);
      }
    }
    if (found.size() != 9) throw std::runtime_error("loud_optima.txt: not the sets of three layouts");
    return found;
  }();
  return all;
}

}  // namespace palpa::array
