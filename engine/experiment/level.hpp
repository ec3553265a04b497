// The level of pressure at which afferents are computed. Linear acoustics gives pressures that are several times too
// high for a loud array. The level is therefore set by a force that somebody has measured or assumes.
#pragma once

#include "array/layouts/layout.hpp"
#include "experiment/observed_finger.hpp"

namespace palpa::experiment {

/// The factor on linear pressures at which the crest of a single focus on the paper's cube, 3 mm deep, is a force of
/// `crest_n` on the finger, and that force at the linear level.
struct Calibration {
  double linear_crest_n = 0;
  double factor(double crest_n) const { return crest_n / linear_crest_n; }
};
/// With this array, posed in the world. Throws bad_input if the finger gets no force there.
Calibration calibrate_level(ObservedFinger& finger, const array::Layout& layout);
/// The same, kept between runs.
Calibration kept_level(ObservedFinger& finger, const array::Layout& layout);

}  // namespace palpa::experiment
