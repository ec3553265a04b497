// What a plan's drives give at its foci.
#pragma once

#include <vector>

#include "session/links/plan.hpp"
#include "session/plan/setting.hpp"

namespace palpa::session {

/// Peak pressures in Pa by `setting`'s directivity, without absorption: an entry for each voice of the plan, in it one
/// for each of the voice's foci. Of a focus' slots that in which it has the least, the others sounding along; of a
/// finger that is modulated at the modulation's crest. 0 for foci that never sound or have no place.
///
/// A plan whose drives are not listed is looked at for its first most_cycle slots.
std::vector<std::vector<double>> foci_pressures(const Plan& plan, const SessionSetting& setting);

}  // namespace palpa::session
