// The layouts that palpa knows by name.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "array/layouts/layout.hpp"

namespace palpa::array {

/// Adds one board of a known type (board_types.hpp) with the pose `T_layout_board`; its transducers are appended to the
/// layout's. Returns false and adds nothing for an unknown type.
bool add_board(Layout& layout, std::string_view type, const Transform& T_layout_board);

/// One board of each type, and beside it the arrays of several.
std::vector<std::string> builtin_layout_names();
std::optional<Layout> builtin_layout(std::string_view name);

/// 150 mm below the world's origin, facing +y: layout x = world x, layout y = world -z.
Transform below_facing_up();

}  // namespace palpa::array
