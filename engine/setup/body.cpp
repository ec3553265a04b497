#include "setup/body.hpp"

#include "acoustics/bodies/body_mesh.hpp"
#include "geometry/files/load_triangles.hpp"

namespace palpa::setup {

geometry::Mesh body_of(const std::string& name, const geometry::Mesh& mesh, const acoustics::Air& air, bool force) {
  geometry::Mesh body = acoustics::body_mesh(name, mesh);
  acoustics::check_fineness(name, body, 1 / air.medium.turns_per_metre(), force);
  acoustics::warn_of_needles(name, body);
  acoustics::check_memory(body);
  return body;
}

geometry::Mesh load_body(const std::string& file, const acoustics::Air& air, bool force) {
  return body_of(file, geometry::load_triangles(file), air, force);
}

}  // namespace palpa::setup
