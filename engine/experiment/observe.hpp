// The computation of `palpa study simulate` up to the ideal observer: every touch of a plan, and what a finger's
// afferents do in it.
#pragma once

#include <string>
#include <vector>

#include "experiment/observed_finger.hpp"
#include "observer/responses.hpp"
#include "study/plan/plan.hpp"

namespace palpa::experiment {

/// The force at the crest of a single focus on the paper's cube, 3 mm deep, at the ceiling of the plan, with the array
/// of the fitted method: at most what the plan assumes for full amplitude. Kept between runs. Throws as
/// calibrate_level() does.
double crest_force_n(const study::StudyPlan& plan, ObservedFinger& finger);

/// The ceiling at which that force would be the one of exact amplitudes and linear acoustics, with the same array;
/// above 1 if full amplitude gives less.
double ceiling_for_n(const study::StudyPlan& plan, double crest_n, ObservedFinger& finger);

/// All touches of the plan's methods and candidates. Results are kept between runs. Reports its progress (Activity).
/// Throws bad_input naming a missing model or layout, otherwise as touch_patterns does.
observer::Responses observe(const study::StudyPlan& plan, ObservedFinger& finger);

}  // namespace palpa::experiment
