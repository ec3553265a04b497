// Labels that lie flat on the picture: how deep fingers are, and what was read under the pointer.
#pragma once

#include <string>
#include <vector>

#include "touch/types.hpp"
#include "viewer/panel_data/panel_data.hpp"

namespace palpa::viewer {

/// Says how deep the touch's fingers are, in `depths` and beside their contacts. `solids`: names, as the touch counts
/// them.
void show_depths(const touch::Touch& touch, const std::vector<std::string>& solids, const Sight& sight,
                 std::vector<Depth>& depths, std::vector<FlatMark>& marks);
/// What was read, below the point that was read.
void show_reading(const Reading& reading, const Sight& sight, std::vector<FlatMark>& marks);

}  // namespace palpa::viewer
