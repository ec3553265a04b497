// The afferents' response as a picture: above, a map of rates for each class, seen from below the finger; below, the
// spikes of the class over time.
#pragma once

#include "drawing/png.hpp"
#include "experiment/afferents_task.hpp"

namespace palpa::experiment {

drawing::Pixels afferents_picture(const AfferentsResult& result);

}  // namespace palpa::experiment
