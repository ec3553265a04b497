// Shapes of any size, for measurements.
#pragma once

#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "geometry/mesh/mesh.hpp"
#include "geometry/solid.hpp"

namespace palpa::bench {

/// A ball with dents, 100 mm across, its top at y = 0: closed, concave nearly everywhere, of about `faces` faces.
geometry::Mesh dented_ball(std::uint32_t faces);

/// An axis-aligned box.
geometry::Mesh box_mesh(const Vec3& low, const Vec3& high);
std::vector<geometry::Solid> box_solid(const Vec3& low, const Vec3& high);

/// `count` points, evenly on an upright finger 16 mm wide and 68 mm long. Its tip is at y = `tip`.
std::vector<glm::vec3> finger_points(std::uint32_t count, double tip);

}  // namespace palpa::bench
