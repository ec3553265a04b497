#include "bench/bench.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <utility>

namespace palpa::bench {

Row make_row(std::string suite, std::string name, std::string stage, std::vector<double> samples_ms) {
  std::sort(samples_ms.begin(), samples_ms.end());
  const auto at = [&](double p) {
    return samples_ms[static_cast<std::size_t>(std::lround(p * static_cast<double>(samples_ms.size() - 1)))];
  };
  Row row{std::move(suite), std::move(name), std::move(stage)};
  row.median_ms = at(0.5);
  row.p99_ms = at(0.99);
  row.least_ms = samples_ms.front();
  row.runs = static_cast<std::uint32_t>(samples_ms.size());
  return row;
}

std::uint64_t peak_resident_bytes() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with("VmHWM:")) return std::stoull(line.substr(6)) * 1024;
  }
  return 0;
}

}  // namespace palpa::bench
