// The output of `palpa touch --json`, checked against the contract while it is read.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "base/math.hpp"

namespace palpa::test {

struct TouchFinger {
  std::string solid;
  std::vector<std::uint32_t> indices;
  Vec3 centroid;
};

struct TouchReport {
  std::uint64_t points = 0;
  std::vector<std::uint32_t> contacts;
  std::vector<double> depths;
  std::vector<TouchFinger> fingers;
  std::string without_times;  ///< the document without backend and timing_ms, which may differ from run to run
};

/// Reads the output of `palpa touch --json`. Checks keys, their order, types and every relation between values that the
/// contract states. `delta` and `foci` are those of the command line.
TouchReport read_touch(const std::string& text, double delta = 1.5e-3, std::size_t foci = 10);

/// Runs a line of `palpa touch` with --json - within this process, expects success without a warning, and reads the
/// output with read_touch().
TouchReport run_touch_here(const std::vector<std::string>& line, double delta = 1.5e-3, std::size_t foci = 10);

}  // namespace palpa::test
