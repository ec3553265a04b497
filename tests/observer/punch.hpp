// A flat punch that is pressed into the skin and lifted again, TouchSim's stimulus: a check of the afferents against
// its published behaviour.
#pragma once

#include <span>

#include "observer/afferents/response.hpp"

namespace palpa::observer {

/// The skin at `distance_mm` from the axis of a punch of this radius while its depth follows `indentation_mm`, one
/// value per sample. A negative depth pulls the skin, as in TouchSim. Beyond the punch's rim, the surface's velocity
/// arrives with the delay of a surface wave, in whole samples. The stress at 0.3 mm is not delayed.
SkinMotion under_punch(std::span<const double> indentation_mm, double radius_mm, double distance_mm);

}  // namespace palpa::observer
