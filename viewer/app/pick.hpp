// Finds what lies under the pointer, where it is and how deep.
#pragma once

#include <optional>

#include "viewer/panel_data/panel_data.hpp"

namespace palpa::viewer {

/// The focus, contact or skin point within a few pixels of x, y, in this order; otherwise the nearest surface of a
/// solid there. Only layers that are shown count. `width`, `height`: the picture in pixels. If the place lies in
/// several solids, the depth is in the one where it is deepest. Looks at every triangle.
std::optional<Reading> pick(const Picture& picture, const ViewState& state, double x, double y, double width,
                            double height, double ratio);

}  // namespace palpa::viewer
