#include "setup/files/body.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "acoustics/bodies/body_mesh.hpp"
#include "base/error.hpp"
#include "geometry/files/load_triangles.hpp"

namespace palpa::setup {

geometry::Mesh body_of(const std::string& name, const geometry::Mesh& mesh, const acoustics::Air& air, bool force) {
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const glm::uvec3& corners = mesh.triangles[t];
    const std::uint32_t largest = std::max({corners.x, corners.y, corners.z});
    if (largest >= mesh.positions.size()) {
      throw bad_input(
          name, fmt::format("triangle {} names vertex {}, but there are only {}", t, largest, mesh.positions.size()));
    }
  }
  geometry::Mesh body = acoustics::body_mesh(name, mesh);
  acoustics::check_fineness(name, body, 1 / air.medium.turns_per_metre(), force);
  acoustics::warn_of_needles(name, body);
  acoustics::warn_of_bends(name, body);
  acoustics::check_memory(body, air.wave_number());
  return body;
}

geometry::Mesh load_body(const std::string& file, const acoustics::Air& air, bool force) {
  return body_of(file, geometry::load_triangles(file), air, force);
}

const JsonRows<acoustics::RigidBody::Effort>& solution_rows() {
  using Effort = acoustics::RigidBody::Effort;
  static const auto rows = JsonRows<Effort>()
                               .value("iterations", [](const Effort& effort) { return effort.worst.iterations; })
                               .value("residual", [](const Effort& effort) { return effort.worst.residual; });
  return rows;
}

void add_solution(JsonWriter& json, const acoustics::RigidBody::Effort& effort) {
  if (effort.iterates) solution_rows().write(json.key("solution"), effort, JsonWriter::Style::line);
}

}  // namespace palpa::setup
