// How the time of a frame grows with the size of the scene, of the skin and of the array.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "bench/bench.hpp"
#include "sensing/depth_source.hpp"
#include "session/plan/setting.hpp"

namespace palpa::bench {

/// A frame, and the session that computes it.
struct GrowthCase {
  session::SessionSetting setting;
  sensing::FrameSet frame;  ///< images if the setting has cameras, otherwise points
};

/// One thing that grows while everything else stays.
struct GrowthAxis {
  const char* name;  ///< what is counted, as a plural
  std::vector<std::uint32_t> sizes;
  GrowthCase (*make)(std::uint32_t size);
};
std::span<const GrowthAxis> growth_axes();

struct GrowthSample {
  double size = 0, ms = 0;
};
struct GrowthCurve {
  std::string name, where;  ///< the axis; "host" or "device"
  std::vector<GrowthSample> samples;
};

/// The time is proportional to the size to this power: 0 does not grow, 1 is linear.
struct Exponents {
  double fitted = 0;    ///< least squares over all sizes, both logarithmic
  double steepest = 0;  ///< between two sizes that are next to each other
};
/// Both are 0 if there are fewer than two samples.
Exponents exponents_of(std::span<const GrowthSample> samples);

constexpr std::uint32_t any_size = std::numeric_limits<std::uint32_t>::max();

/// Times a frame for each size of each axis up to `most_size`, on the host and on the device. The note of a row says
/// which steps take the most, that of the last size the exponents.
std::vector<GrowthCurve> measure_growth(const Context& context, std::uint32_t most_size, std::vector<Row>& rows);

}  // namespace palpa::bench
