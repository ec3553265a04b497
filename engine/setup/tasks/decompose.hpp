// What `palpa decompose` computes: the convex parts of a scene's solids, and how well they match them. The method is in
// geometry/parts/decompose.hpp. Metres, world frame.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "geometry/gltf/gltf.hpp"
#include "geometry/parts/decompose.hpp"
#include "geometry/solid.hpp"

namespace palpa::setup {

struct DecomposeTask {
  std::string scene;                        ///< glTF file
  std::optional<std::uint32_t> gltf_scene;  ///< scene of the file; nothing: the file's own
  geometry::DecomposeOptions options;
  std::uint64_t seed = 0;  ///< of the points by which parts are measured
};

/// A solid, and what it is the union of.
struct Decomposed {
  geometry::Solid solid;
  geometry::Parts parts;
  geometry::PartsReport report;
  double seconds = 0;  ///< that the cutting took
};
/// What `palpa decompose --json` writes (docs/files.md); `file` is where the parts are written to.
std::string to_json(const std::vector<Decomposed>& solids, const std::string& file);

/// The parts as meshes of a scene (geometry/gltf/write.hpp), marked so that reading it makes them their solids again.
std::vector<geometry::SceneMesh> part_meshes(const std::vector<Decomposed>& solids);

/// Every mesh of the scene that can be touched, in its order. An open one is closed first, with a warning. `all_read`
/// is called once the scene is read and the long work begins. Throws bad_input for a scene without such a mesh, for one
/// that consists of parts already and for a mesh that cannot be cut; failure as geometry::decompose does.
std::vector<Decomposed> decompose(const DecomposeTask& task, const std::function<void()>& all_read = {});

}  // namespace palpa::setup
