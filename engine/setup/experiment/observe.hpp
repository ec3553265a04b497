// The computation of `palpa study simulate` up to the ideal observer: every touch of a plan, and what a finger's
// afferents do in it.
#pragma once

#include <string>
#include <vector>

#include "setup/experiment/observed_finger.hpp"
#include "study/files/plan_file.hpp"
#include "study/observer/responses.hpp"

namespace palpa::setup {

/// The factor on linear pressures at which the crest of a single focus on the paper's cube, 3 mm deep, is a force of
/// `crest_n` on the finger, and that force at the linear level.
struct Calibration {
  double linear_crest_n = 0;
  double factor(double crest_n) const { return crest_n / linear_crest_n; }
};
/// With this array, posed in the world. Throws bad_input if the finger touches nothing there or gets no force.
Calibration calibrate_level(ObservedFinger& finger, const array::Layout& layout);

/// The response to one pattern at these levels, with all that the variants of the observer need.
study::TouchResponse respond_to(ObservedFinger& finger, const study::PressurePattern& pattern,
                                const std::vector<double>& factors);

/// All touches of the plan's methods and candidates. Results are kept between runs. Reports its progress (Activity).
/// Throws bad_input naming a missing model or layout, otherwise as touch_patterns does.
study::Responses observe(const study::StudyPlan& plan, ObservedFinger& finger);

}  // namespace palpa::setup
