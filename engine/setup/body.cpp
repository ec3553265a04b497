#include "setup/body.hpp"

#include "acoustics/bodies/body_mesh.hpp"
#include "geometry/files/load_triangles.hpp"

namespace palpa::setup {

geometry::Mesh load_body(const std::string& file, const acoustics::Air& air, bool force) {
  geometry::Mesh body = acoustics::body_mesh(file, geometry::load_triangles(file));
  acoustics::check_fineness(file, body, 1 / air.medium.turns_per_metre(), force);
  acoustics::warn_of_needles(file, body);
  acoustics::check_memory(body);
  return body;
}

}  // namespace palpa::setup
