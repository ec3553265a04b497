// The cells that contacts are sorted into to find clusters, for the pass and its twin.
#pragma once

#include <algorithm>

#include "shaders/touch/clusters/clusters.h"
#include "touch/types.hpp"

namespace palpa::touch {

/// Density of the cells for a gap. Contacts of one cell are within the gap despite rounding.
inline float cells_per_metre(float gap) {
  return 1.0F / (static_cast<float>(shader::clusters_cell_thousandths) * 1e-3F * gap);
}

/// The gap in single precision. A gap larger than every solid means one cluster per solid. It is limited so that its
/// square stays finite.
inline float float_gap(const FingerOptions& parameters) {
  return std::min(static_cast<float>(parameters.finger_gap_m), 1e9F);
}

}  // namespace palpa::touch
