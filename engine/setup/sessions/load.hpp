// Loads the data of a session from files: the scene's solids and the physical set-up.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "array/layouts/layout.hpp"
#include "geometry/solid.hpp"
#include "sensing/rig.hpp"
#include "setup/options/options.hpp"

namespace palpa::setup {

/// The scene's solids. With `options.surface` parts, each solid is decomposed, unless it already consists of parts.
/// Throws bad_input naming file and fault, also for a scene without a solid. Throws bad_usage for options of parts if
/// there are no parts.
std::vector<geometry::Solid> load_solids(const std::string& scene, const std::optional<std::uint32_t>& gltf_scene = {},
                                         const SolidOptions& options = {});
/// The same of a scene that is read already, or comes from no file.
std::vector<geometry::Solid> solids_of(const geometry::Scene& scene, const SolidOptions& options = {});

/// The physical set-up.
struct PosedRig {
  sensing::Rig rig;
  array::Layout layout;  ///< as posed in the world
  Transform T_world_layout{1.0};
};

/// A layout and its pose.
struct PlacedLayout {
  array::Layout layout;  ///< in its own frame
  Transform T_world_layout{1.0};
};

/// The array of the rig, or with --layout that layout in its default pose. In the latter case, no rig is read unless
/// one is named. Throws as load_posed_rig does.
PlacedLayout load_placed_layout(const RigOptions& options);

/// The layout of that name or file, in its default pose in the world.
array::Layout load_posed_layout(const std::string& layout);

/// The rig (default: the paper's) and its array; --layout replaces the array, which then has the default pose of that
/// layout. Throws bad_input; if the rig names an invalid layout, with the rig's line.
PosedRig load_posed_rig(const RigOptions& options);

}  // namespace palpa::setup
