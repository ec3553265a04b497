// What lies under the pointer, for whoever wants to know where it is and how deep.
#pragma once

#include <optional>

#include "viewer/panels/desk.hpp"

namespace palpa::viewer {

/// The focus, contact or skin point within a few pixels of x, y, in this order, else the nearest surface of a solid
/// there. Of layers that are shown. `width`, `height`: of the picture in pixels. A depth is that of the place in the
/// solid in which it lies deepest; looks at every triangle.
std::optional<Reading> pick(const Picture& picture, const ViewState& state, double x, double y, double width,
                            double height, double ratio);

}  // namespace palpa::viewer
