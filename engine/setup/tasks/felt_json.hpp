// What skin feels over time, as JSON: --spectrum, and the values that --tune chose.
#pragma once

#include "acoustics/felt/spectrum.hpp"
#include "base/files/json_rows.hpp"
#include "session/plan/scheduler.hpp"

namespace palpa::setup {

/// What is written of a finger that touches.
struct FeltFinger {
  const session::ScheduledFinger& scheduled;
  const acoustics::Spectrum* spectrum = nullptr;  ///< null if it was not requested
};
/// The members "tune" and "spectrum" of a finger's object, each only if it was requested.
const JsonRows<FeltFinger>& felt_rows();

}  // namespace palpa::setup
