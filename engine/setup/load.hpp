// What a session stands on, from its files: the scene's solids and the physical set-up.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "array/layout.hpp"
#include "geometry/solid.hpp"
#include "sensing/rig.hpp"
#include "setup/options.hpp"

namespace palpa::setup {

/// The scene's solids. With `options.surface` parts each is taken apart, unless it came as parts. Throws bad_input
/// naming file and fault; a scene without a solid is one. Throws bad_usage for options of parts where there are none.
std::vector<geometry::Solid> load_solids(const std::string& scene, const std::optional<std::uint32_t>& gltf_scene = {},
                                         const SolidOptions& options = {});

/// The physical set-up.
struct PosedRig {
  sensing::Rig rig;
  array::Layout layout;  ///< as posed in the world
  Transform T_world_layout{1.0};
};

/// A layout, and where it stands.
struct PlacedLayout {
  array::Layout layout;  ///< in its own frame
  Transform T_world_layout{1.0};
};

/// The array of the rig or, with --layout, that layout where it stands by default; then no rig is read unless one is
/// named. Throws as load_posed_rig does.
PlacedLayout load_placed_layout(const RigOptions& options);

/// The layout of that name or file, as it stands in the world by default.
array::Layout load_posed_layout(const std::string& layout);

/// The rig (default: the paper's) and its array; --layout replaces the array, which then stands where that layout
/// stands by default. Throws bad_input; of a layout that the rig names and that is none, with the rig's line.
PosedRig load_posed_rig(const RigOptions& options);

}  // namespace palpa::setup
