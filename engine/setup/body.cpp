#include "setup/body.hpp"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <utility>

#include "acoustics/body_mesh.hpp"
#include "geometry/gltf.hpp"
#include "geometry/ply.hpp"

namespace palpa::setup {

geometry::Mesh load_triangles(const std::string& file) {
  std::string ending = std::filesystem::path(file).extension().string();
  std::ranges::transform(ending, ending.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  geometry::Mesh mesh;
  if (ending == ".gltf" || ending == ".glb") {
    for (const geometry::SceneMesh& part : geometry::load_gltf(file).meshes)
      geometry::append(mesh, part.mesh);
  } else {
    geometry::Ply ply = geometry::read_ply(file);
    mesh = {std::move(ply.positions), std::move(ply.triangles)};
  }
  return mesh;
}

geometry::Mesh load_body(const std::string& file, const acoustics::Air& air, bool force) {
  geometry::Mesh body = acoustics::body_mesh(file, load_triangles(file));
  acoustics::check_fineness(file, body, 1 / air.medium.turns_per_metre(), force);
  acoustics::check_memory(body);
  return body;
}

}  // namespace palpa::setup
