#include "bench/bench.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <cmath>
#include <fstream>
#include <string_view>
#include <utility>

#include "base/error.hpp"
#include "base/system/now.hpp"

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

std::vector<double> time_runs(const Context& context, const std::string& what, std::uint32_t most,
                              const std::function<void()>& work) {
  constexpr std::size_t few = 3;
  const double enough_ms = context.runs;
  std::vector<double> samples;
  double total_ms = 0;
  while (samples.size() < most && (total_ms < enough_ms || (samples.size() < few && total_ms < few * enough_ms))) {
    const double begin_ms = now_ms();
    work();
    samples.push_back(now_ms() - begin_ms);
    total_ms += samples.back();
    context.progress(what, samples.size(), most);
  }
  context.progress(what, most, most);
  return samples;
}

void wrong(const std::string& what) {
  throw failure(fmt::format("bench: {}; nothing was timed", what));
}

void twins_disagree(const std::string& name) {
  wrong(name + ": device and C++ twin disagree");
}

namespace {

std::uint64_t bytes_in_status(std::string_view key) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with(key)) return std::stoull(line.substr(key.size())) * 1024;
  }
  return 0;
}

}  // namespace

std::uint64_t resident_bytes() {
  return bytes_in_status("VmRSS:");
}

std::uint64_t peak_resident_bytes() {
  return bytes_in_status("VmHWM:");
}

}  // namespace palpa::bench
