// The computation of `palpa study simulate` up to the ideal observer: every touch of a plan, and what a finger's
// afferents do in it.
#pragma once

#include <string>
#include <vector>

#include "setup/experiment/observed_finger.hpp"
#include "study/observer/responses.hpp"
#include "study/plan/plan.hpp"

namespace palpa::setup {

/// All touches of the plan's methods and candidates. Results are kept between runs. Reports its progress (Activity).
/// Throws bad_input naming a missing model or layout, otherwise as touch_patterns does.
study::Responses observe(const study::StudyPlan& plan, ObservedFinger& finger);

}  // namespace palpa::setup
