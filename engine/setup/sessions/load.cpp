#include "setup/sessions/load.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <glm/geometric.hpp>
#include <utility>

#include "base/activity.hpp"
#include "base/error.hpp"
#include "base/log.hpp"
#include "base/text.hpp"
#include "geometry/gltf/gltf.hpp"
#include "geometry/parts_solid.hpp"
#include "setup/files/assets.hpp"
#include "setup/options/warnings.hpp"

namespace palpa::setup {
namespace {

geometry::Scene read_scene(const std::string& file, const std::optional<int>& index) {
  const Activity work("reading " + file);
  return geometry::load_gltf(file, index);
}

/// A name without a layout is an error of the rig, not of the layout.
array::Layout load_layout_of(const sensing::ArrayPlacement& array) {
  if (!array::is_layout(array.layout)) {
    throw bad_input(array.where, fmt::format("layout is {}, neither a file nor a known layout; known: {}",
                                             printable(array.layout, 200), array::known_layouts()));
  }
  return array::load_layout(array.layout);
}

PlacedLayout standing_by_default(const std::string& name) {
  array::Layout layout = array::load_layout(name);
  const Transform pose = layout.default_T_world_layout;
  return {std::move(layout), pose};
}

sensing::Rig load_rig_of(const RigOptions& options) {
  return sensing::load_rig(options.rig.empty() ? find_asset("rigs/paper.toml") : options.rig);
}

void warn_of_moved_array(const sensing::Rig& rig, const std::string& layout, const Transform& T_world_layout) {
  const double far_m = glm::distance(Vec3(T_world_layout[3]), Vec3((*rig.array->T_world_layout)[3]));
  if (far_m < 1e-3) return;
  log::warning(
      fmt::format("{}: --layout {} puts the array at its usual place, {:.0f} mm from the one in [array]; leave "
                  "--layout out to keep "
                  "that",
                  rig.file, layout, far_m * 1e3));
}

/// `layout` replaces the rig's array.
PlacedLayout array_of(const sensing::Rig& rig, const std::string& layout) {
  if (!layout.empty()) {
    PlacedLayout placed = standing_by_default(layout);
    if (rig.array && rig.array->T_world_layout && rig.array->layout == layout)
      warn_of_moved_array(rig, layout, placed.T_world_layout);
    return placed;
  }
  if (!rig.array) throw bad_input(rig.file, "has no [array]; add one or give --layout");
  array::Layout own = load_layout_of(*rig.array);
  const Transform pose = rig.array->T_world_layout.value_or(own.default_T_world_layout);
  return {std::move(own), pose};
}

void refuse_idle_parts(const SolidOptions& options) {
  if (options.parts && options.surface != geometry::SurfaceKind::parts)
    throw bad_usage("--parts goes with --surface parts");
}

array::Layout in_world(const PlacedLayout& placed) {
  return transformed(placed.layout, placed.T_world_layout);
}

}  // namespace

std::vector<geometry::Solid> load_solids(const std::string& scene, const std::optional<std::uint32_t>& gltf_scene,
                                         const SolidOptions& options) {
  refuse_idle_parts(options);
  const std::optional<int> index = gltf_scene ? std::optional(static_cast<int>(*gltf_scene)) : std::nullopt;
  return solids_of(read_scene(scene, index), options);
}

std::vector<geometry::Solid> solids_of(const geometry::Scene& scene, const SolidOptions& options) {
  refuse_idle_parts(options);
  const bool into_parts = options.surface == geometry::SurfaceKind::parts;
  std::vector<geometry::Solid> solids = geometry::make_solids(scene, options.surface);
  warn_of_dwell(solids);
  warn_of_size(solids);
  const auto has_parts = [](const geometry::Solid& solid) { return !solid.parts.parts.empty(); };
  if (options.internal_faces && !into_parts && std::none_of(solids.begin(), solids.end(), has_parts)) {
    throw bad_usage("--internal-faces goes with --surface parts, or with a scene of parts");
  }
  for (geometry::Solid& solid : solids) {
    solid.internal_faces = options.internal_faces.value_or(geometry::InternalFaces::drop);
    if (into_parts && !has_parts(solid))
      geometry::use_parts(solid, {.parts = options.parts.value_or(geometry::DecomposeOptions().parts)}, {});
  }
  return solids;
}

PlacedLayout load_placed_layout(const RigOptions& options) {
  if (options.rig.empty() && !options.layout.empty()) return standing_by_default(options.layout);
  return array_of(load_rig_of(options), options.layout);
}

array::Layout load_posed_layout(const std::string& name) {
  return in_world(standing_by_default(name));
}

PosedRig load_posed_rig(const RigOptions& options) {
  PosedRig set_up;
  set_up.rig = load_rig_of(options);
  const PlacedLayout placed = array_of(set_up.rig, options.layout);
  set_up.layout = in_world(placed);
  set_up.T_world_layout = placed.T_world_layout;
  return set_up;
}

}  // namespace palpa::setup
