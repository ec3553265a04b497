// One touch: a session of one frame, on either backend.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "base/system/now.hpp"
#include "gpu/device.hpp"
#include "session/session.hpp"
#include "setup/options/options.hpp"
#include "setup/sessions/touch_input.hpp"

namespace palpa::setup {

/// Steps in the order they ran, with their times in ms.
using StepTimes = std::vector<std::pair<std::string, double>>;

/// A session and the touch of its frame.
struct OneTouch {
  UsedDevice device;
  session::Session session;
  const touch::Touch& touch;  ///< the session's
};

/// The array of the touch. Without transducers, nothing sounds.
struct TouchArray {
  array::Layout layout;  ///< in the world
  array::DriveOptions drive;
  std::optional<double> pressure_pa{};           ///< requested at each focus
  const acoustics::FocusField* field = nullptr;  ///< see SessionSetting
};

/// Contacts, fingers, foci and schedule of `input`'s skin on `solids`, whose file is `scene`, and the drives of
/// `array`. `own_method`, if given, places the foci. `kept_solids`, if given, keeps what is prepared of the solids for
/// the next touch of the same. Adds the steps' times to `times`. Throws bad_usage for more points
/// than the backend can hold and for parameters that do not fit the scene, otherwise as Session does.
OneTouch touch_once(const ComputeOptions& compute, const TouchOptions& touch, const FeltOptions& felt,
                    const std::string& scene, std::vector<geometry::Solid> solids, const TouchInput& input,
                    TouchArray array, StepTimes& times, session::OwnMethod own_method = {},
                    std::shared_ptr<touch::KeptSolids> kept_solids = {});

/// Milliseconds since its construction or the last lap.
class Stopwatch {
 public:
  double lap_ms() {
    const double before_ms = std::exchange(last_ms_, now_ms());
    return last_ms_ - before_ms;
  }

 private:
  double last_ms_ = now_ms();
};

}  // namespace palpa::setup
