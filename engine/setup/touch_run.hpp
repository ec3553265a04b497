// One touch: a session of one frame, on either backend.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "gpu/device.hpp"
#include "session/session.hpp"
#include "setup/options.hpp"
#include "setup/touch_input.hpp"

namespace palpa::setup {

/// Stages in the order they ran, and how long each took.
using StepTimes = std::vector<std::pair<std::string, double>>;

/// A session and what its frame touches.
struct OneTouch {
  std::unique_ptr<gpu::Device> device;  ///< none on the CPU
  session::Session session;
  const touch::Touch& touch;  ///< the session's
};

/// What sounds for it. Without transducers nothing does.
struct TouchArray {
  array::Layout layout;  ///< in the world
  array::DriveOptions drive;
  std::optional<double> pressure_pa{};           ///< asked for at each focus
  const acoustics::FocusField* field = nullptr;  ///< see SessionSetting
};

/// Contacts, fingers, foci and schedule of `input`'s skin on `solids`, of which `scene` is the file, and the drives of
/// `array`; adds the stages' times. Throws bad_usage where there are more points than the backend can hold and on
/// parameters that do not fit the scene, else as Session does.
OneTouch touch_once(const ComputeOptions& compute, const TouchOptions& touch, const FeltOptions& felt,
                    const std::string& scene, std::vector<geometry::Solid> solids, const TouchInput& input,
                    TouchArray array, StepTimes& times);

/// Milliseconds since its construction or the last lap.
class Stopwatch {
 public:
  Stopwatch();
  double lap_ms();

 private:
  std::int64_t last_ns_;
};

}  // namespace palpa::setup
