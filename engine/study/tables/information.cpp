#include "study/tables/information.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace palpa::study {

Information information(const Confusion& table) {
  Information found;
  const auto n = static_cast<double>(table.total());
  if (n == 0) return found;
  double rows = 0, columns = 0;  // that are not empty
  for (std::size_t i = 0; i < table.size(); ++i) {
    const double row = static_cast<double>(table.row(i)) / n;
    rows += row > 0 ? 1 : 0;
    columns += table.column(i) > 0 ? 1 : 0;
    if (row > 0) found.most_bits -= row * std::log2(row);
  }
  for (std::size_t i = 0; i < table.size(); ++i) {
    for (std::size_t j = 0; j < table.size(); ++j) {
      const double expected = static_cast<double>(table.row(i)) * static_cast<double>(table.column(j)) / n;
      if (expected == 0) continue;
      const auto count = static_cast<double>(table.at(i, j));
      if (count > 0) found.bits += count / n * std::log2(count / expected);
      found.chi_square += (count - expected) * (count - expected) / expected;
    }
  }
  found.bits = std::max(0.0, found.bits);
  found.corrected_bits = found.bits - (rows - 1) * (columns - 1) / (2 * n * std::numbers::ln2);
  return found;
}

}  // namespace palpa::study
