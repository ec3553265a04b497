// What `palpa touch --json` printed, checked against the contract while it is read.
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "base/math.hpp"
#include "process.hpp"

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
  std::string without_times;  ///< the document less timing_ms, which may differ from run to run
};

/// Runs `palpa touch ... --json -` in this process, expects success, and checks keys, their order, types and every
/// relation between values that the contract states. `delta` and `foci` are those of the command line.
TouchReport run_touch(const std::vector<std::string>& arguments, double delta = 1.5e-3, std::size_t foci = 10);
/// The same by the program, whose delta and foci are the usual ones.
TouchReport run_touch_program(const std::vector<std::string>& arguments, const RunOptions& options = {});

}  // namespace palpa::test
