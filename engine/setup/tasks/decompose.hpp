// The computation of `palpa decompose`: the convex parts of a scene's solids, and how well the parts match the solids.
// The method is in geometry/parts/decompose.hpp. Metres, world frame.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "geometry/gltf/gltf.hpp"
#include "geometry/parts/decompose.hpp"
#include "geometry/solid.hpp"

namespace palpa::line {
class Group;
}

namespace palpa::setup {

struct DecomposeTask {
  std::string scene;                        ///< glTF file
  std::optional<std::uint32_t> gltf_scene;  ///< scene of the file; empty: the file's default scene
  geometry::DecomposeOptions options;
  std::uint64_t seed = 0;  ///< for the points with which parts are measured
};
/// --parts, --resolution and --error.
void add_decompose_options(const line::Group& group, geometry::DecomposeOptions& options);

/// A solid, and the parts of which it is the union.
struct Decomposed {
  geometry::Solid solid;
  geometry::Parts parts;
  geometry::PartsReport report;
  double seconds = 0;  ///< time for the decomposition
};
/// The output of `palpa decompose --json` (docs/parts.md); `file` is the file with the parts.
std::string to_json(const std::vector<Decomposed>& solids, const std::string& file);

/// The parts as meshes of a scene (geometry/gltf/write.hpp), marked so that a reader reassembles them to their solids.
std::vector<geometry::SceneMesh> part_meshes(const std::vector<Decomposed>& solids);

/// Decomposes every mesh of the scene that can be touched, in the scene's order. An open mesh is closed first, with a
/// warning. `all_read` is called after the scene is read and before the long computation begins. Throws bad_input for a
/// scene without such a mesh, for a scene that already consists of parts, and for a mesh that cannot be decomposed.
/// Throws failure as geometry::decompose does.
std::vector<Decomposed> decompose(const DecomposeTask& task, const std::function<void()>& all_read = {});

}  // namespace palpa::setup
