// The computation of `palpa study simulate` up to the ideal observer: every touch of a plan, and what a finger's
// afferents do in it.
#pragma once

#include <string>
#include <vector>

#include "setup/experiment/observed_finger.hpp"
#include "study/files/plan_file.hpp"
#include "study/observer/responses.hpp"

namespace palpa::setup {

/// The response to one pattern at these levels, with all that the variants of the observer need.
study::TouchResponse respond_to(ObservedFinger& finger, const study::PressurePattern& pattern,
                                const std::vector<double>& factors);

/// All touches of the plan's methods and candidates. Results are kept between runs. Reports its progress (Activity).
/// Throws bad_input naming a missing model or layout, otherwise as touch_patterns does.
study::Responses observe(const study::StudyPlan& plan, ObservedFinger& finger);

}  // namespace palpa::setup
