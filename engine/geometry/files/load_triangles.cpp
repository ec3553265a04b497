#include "geometry/files/load_triangles.hpp"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <utility>

#include "geometry/files/ply.hpp"
#include "geometry/gltf/gltf.hpp"

namespace palpa::geometry {

Mesh load_triangles(const std::string& file) {
  std::string ending = std::filesystem::path(file).extension().string();
  std::ranges::transform(ending, ending.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (ending != ".gltf" && ending != ".glb") {
    Ply ply = read_ply(file);
    return {std::move(ply.positions), std::move(ply.triangles)};
  }
  Mesh mesh;
  for (const SceneMesh& part : load_gltf(file).meshes)
    append(mesh, part.mesh);
  return mesh;
}

}  // namespace palpa::geometry
