// One touch, on either backend.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "setup/options.hpp"
#include "setup/touch_input.hpp"
#include "touch/types.hpp"

namespace palpa::setup {

/// Stages in the order they ran, and how long each took.
using StageTimes = std::vector<std::pair<std::string, double>>;

/// Finds contacts, fingers and foci; adds the stages' times. Throws bad_input where there are more points than the
/// backend can hold, bad_usage on parameters that do not fit the scene.
touch::Touch touch_on_cpu(const TouchInput& input, const touch::Parameters& parameters, StageTimes& times);
touch::Touch touch_on_gpu(const gpu::DeviceOptions& select, const TouchInput& input,
                          const touch::Parameters& parameters, StageTimes& times);

/// Milliseconds since its construction or the last lap.
class Stopwatch {
 public:
  Stopwatch();
  double lap_ms();

 private:
  std::int64_t last_ns_;
};

}  // namespace palpa::setup
