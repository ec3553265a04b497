// The pressures of a plan's drives at its foci.
#pragma once

#include <vector>

#include "session/plan/plan.hpp"
#include "session/plan/setting.hpp"

namespace palpa::session {

/// Peak pressures in Pa with `setting`'s directivity, without absorption: an entry for each voice of the plan, with one
/// value for each of the voice's foci. The value of a focus is the least over its slots, with the other foci sounding
/// as well. For a modulated finger, it is the value at the modulation's crest. 0 for foci that never sound or have no
/// position.
///
/// If a plan's drives are not listed, its first most_cycle slots are evaluated.
std::vector<std::vector<double>> foci_pressures(const Plan& plan, const SessionSetting& setting);

}  // namespace palpa::session
