// What the options say about the schedules of fingers, and what skin feels of them.
#pragma once

#include <vector>

#include "acoustics/felt/spectrum.hpp"
#include "acoustics/felt/tune.hpp"
#include "array/schedule.hpp"
#include "session/plan/scheduler.hpp"
#include "session/session.hpp"
#include "setup/options.hpp"

namespace palpa::setup {

/// Of a loop, where --tune chooses strides.
session::ScheduleOptions schedule_options(const TouchOptions& options);
/// Of a single touch, where --tune chooses foci and, in the range that `felt` gives, dwells as well.
session::ScheduleOptions schedule_options(const TouchOptions& options, const FeltOptions& felt);

/// What skin feels of each finger of the session's newest frame: of its field or, where it has none, of spots.
std::vector<acoustics::Spectrum> spectra_of(const session::Session& session);
/// The same of what plays, one per voice.
std::vector<acoustics::Spectrum> spectra_of(const array::Schedule& schedule, const acoustics::SpectrumOptions& options);

}  // namespace palpa::setup
