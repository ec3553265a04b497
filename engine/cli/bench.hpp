// How fast this machine does what palpa does. Every case checks its result against the C++ twins before it is timed.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "gpu/device.hpp"

namespace palpa::cli {

/// One row of the report: a stage of a case, or the whole of it ("total").
struct BenchRow {
  std::string suite, name, stage;
  double median_ms = 0, p99_ms = 0, least_ms = 0;
  std::uint32_t runs = 0;
  double value = 0;  ///< a rate at the median, a size or a ratio, in `unit`; 0 where the times say it all
  std::string unit;
  std::string note;  ///< how good the result was, where that is part of the measure
};

struct BenchContext {
  const gpu::Device& device;
  std::uint32_t runs = 200;
  std::string scene;  ///< a further model for bench_surface; may be empty
  std::function<void(const std::string& what, std::uint64_t done, std::uint64_t total)> progress;
};

/// Depth frames in host memory to drives in host memory, one frame at a time.
void bench_loop(const BenchContext& context, std::vector<BenchRow>& rows);
/// Drives in batches and for one frame.
void bench_array(const BenchContext& context, std::vector<BenchRow>& rows);
/// Ten foci at once by each solver, on the device and by the twins.
void bench_solvers(const BenchContext& context, std::vector<BenchRow>& rows);
/// Skin points to foci.
void bench_touch(const BenchContext& context, std::vector<BenchRow>& rows);
/// Methods and tuning, on the host.
void bench_methods(const BenchContext& context, std::vector<BenchRow>& rows);

/// Solids of many faces: how long and how much memory it takes to prepare one, from scratch and from the cache, and the
/// contacts of a full three-camera frame against those of the cube.
void bench_surface(const BenchContext& context, std::vector<BenchRow>& rows);

/// Median, 99th percentile and least of `samples_ms` as a row.
BenchRow bench_row(std::string suite, std::string name, std::string stage, std::vector<double> samples_ms);

/// Highest resident memory of this process so far, in bytes.
std::uint64_t peak_resident_bytes();

}  // namespace palpa::cli
