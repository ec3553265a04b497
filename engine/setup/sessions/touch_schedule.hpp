// From the options to the schedules of fingers, and to what skin feels of them.
#pragma once

#include <vector>

#include "acoustics/felt/spectrum.hpp"
#include "acoustics/felt/tune.hpp"
#include "array/schedule.hpp"
#include "session/plan/scheduler.hpp"
#include "session/session.hpp"
#include "setup/options/options.hpp"

namespace palpa::setup {

/// For a loop, where --tune chooses strides.
session::ScheduleOptions schedule_options(const TouchOptions& options);
/// For a single touch, where --tune chooses foci and also dwells, within the range in `felt`.
session::ScheduleOptions schedule_options(const TouchOptions& options, const FeltOptions& felt);

/// What skin feels of each finger of the session's newest frame, computed from the session's field, or from spots if
/// there is none.
std::vector<acoustics::Spectrum> spectra_of(const session::Session& session);
/// The same for a schedule, one per voice.
std::vector<acoustics::Spectrum> spectra_of(const array::Schedule& schedule, const acoustics::SpectrumOptions& options);

}  // namespace palpa::setup
