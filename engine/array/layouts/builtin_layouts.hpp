// The layouts that palpa knows by name, and the board types that a layout TOML may place.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "array/layouts/layout.hpp"

namespace palpa::array {

/// Adds one board of a known type (`autd3`, `openmpd`, `sonicsurface`) with the pose `T_layout_board`; its transducers
/// are appended to the layout's. Returns false and adds nothing for an unknown type.
bool add_board(Layout& layout, std::string_view type, const Transform& T_layout_board);
std::vector<std::string> board_types();

std::optional<Layout> builtin_layout(std::string_view name);

/// 150 mm below the world's origin, facing +y: layout x = world x, layout y = world -z.
Transform below_facing_up();

}  // namespace palpa::array
