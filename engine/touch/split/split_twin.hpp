// Fingers side by side that are one cluster, and clusters that are none: what the depth pictures say of a cluster's own
// skin, before patches are joined across hidden skin (bridge_twin.hpp).
//
// - A cluster is a ghost where the pictures show a surface at less than half of its contacts: flying pixels.
// - A cluster that is wider than a finger is several fingers where a valley is seen between them (docs/touch.md tells
//   how): along the way from contact to contact in a picture the skin falls off and rises again.
#pragma once

#include "touch/bridge/sight.hpp"
#include "touch/types.hpp"

namespace palpa::touch {

/// C++ twin of SplitPass, for fingers of `out` whose contacts' points are pixels of the pictures. Fingers stay in the
/// order of their smallest contacts; parts of fewer than min_points contacts are none. With Cluster::inside nothing is
/// split. The arithmetic is the pass's; where a device divides and takes roots exactly, so are the decisions.
void split_fingers(const Sight& sight, const Parameters& parameters, Touch& out);

/// As SplitPass and its twin take it: metres, 0 where nothing is to be split.
float splitting_width(const Parameters& parameters);

}  // namespace palpa::touch
