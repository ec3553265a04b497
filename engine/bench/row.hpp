// A row of the report of `palpa bench`. The engine and the driver make rows for their measurements.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace palpa::bench {

/// A stage of a case, or the complete case ("total").
struct Row {
  std::string suite, name, stage;
  double median_ms = 0, p99_ms = 0, least_ms = 0;
  std::uint32_t runs = 0;
  double value = 0;  ///< a rate at the median, a size or a ratio, in `unit`; 0 if the times are sufficient
  std::string unit;
  std::string note;  ///< the quality of the result, if that is part of the measurement
};

/// Median, 99th percentile and least of `samples_ms` as a row.
Row make_row(std::string suite, std::string name, std::string stage, std::vector<double> samples_ms);

}  // namespace palpa::bench
