// A row of what `palpa bench` reports, for whoever measures something: the engine, or a room above it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace palpa::bench {

/// A stage of a case, or the whole of it ("total").
struct Row {
  std::string suite, name, stage;
  double median_ms = 0, p99_ms = 0, least_ms = 0;
  std::uint32_t runs = 0;
  double value = 0;  ///< a rate at the median, a size or a ratio, in `unit`; 0 where the times say it all
  std::string unit;
  std::string note;  ///< how good the result was, where that is part of the measure
};

/// Median, 99th percentile and least of `samples_ms` as a row.
Row make_row(std::string suite, std::string name, std::string stage, std::vector<double> samples_ms);

}  // namespace palpa::bench
