// What a finger's afferents do in every touch of a study: the input of the ideal observer.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "observer/afferents/models.hpp"

namespace palpa::observer {

inline constexpr std::size_t model_count = 17;

/// One touch: a shape, a method, a depth and a placement. All empty if nothing sounds.
struct TouchResponse {
  /// Spikes in the counting window, one entry per level of Responses: [level][site * model_count + model].
  std::vector<std::vector<float>> counts;
  std::vector<float> at_once;      ///< the same at the reference level, if no wave took time
  std::vector<float> mean_stress;  ///< per site, N/mm2, at the linear level
  /// Per site, mm: root mean square of the deflection, weighted by the sensitivity of RA and of PC (skin.hpp).
  std::vector<float> flutter, vibration;
};

/// A level of pressure: a factor on the linear pressures.
struct Level {
  std::string name;
  double factor = 1;
  double force_n = 0;  ///< the crest of the single focus on the reference touch at this level
  /// The ceiling of the amplitudes in the plan, if this is the level at which the study is to be run. The observer's
  /// noise is not fitted there: it is that of the reference.
  std::optional<double> plan_ceiling{};
};

struct Responses {
  std::vector<std::string> shapes, methods;
  std::vector<double> depths_m;
  std::uint32_t placements = 0;
  std::vector<Level> levels;      ///< the first is the reference
  std::vector<double> areas_cm2;  ///< of the sites
  double seconds_counted = 0;     ///< the length of the counting window
  std::vector<TouchResponse> touches;

  std::size_t index(std::size_t method, std::size_t shape, std::size_t depth, std::size_t placement) const {
    return ((method * shapes.size() + shape) * depths_m.size() + depth) * placements + placement;
  }
  const TouchResponse& at(std::size_t method, std::size_t shape, std::size_t depth, std::size_t placement) const {
    return touches[index(method, shape, depth, placement)];
  }
};

/// The length of the signals and the beginning of the counting window, samples: a tenth of a second passes until the
/// slowest membranes are in their steady state.
inline constexpr std::size_t observed_samples = 2000, settling_samples = 500;

}  // namespace palpa::observer
