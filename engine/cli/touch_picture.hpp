// A touch as two pictures, seen from below: where the foci are, and the pressure on the skin.
#pragma once

#include <string>
#include <vector>

#include "cli/simulate.hpp"
#include "drawing/png.hpp"

namespace palpa::cli {

/// How deep the skin lies below the solids' top, crosses where the foci are, as the paper's Fig. 6 (1a) to (4a).
drawing::Pixels foci_picture(const Felt& felt, double top_y, const std::string& title);
/// The time-averaged radiation pressure beside its largest value, as (1b) to (4b).
drawing::Pixels pressure_picture(const Felt& felt, const std::string& title);

/// Half as wide and high.
drawing::Pixels halved(const drawing::Pixels& picture);
/// Pictures of one size in rows of `columns`.
drawing::Pixels side_by_side(const std::vector<drawing::Pixels>& pictures, std::uint32_t columns);

}  // namespace palpa::cli
