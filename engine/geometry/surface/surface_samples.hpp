// Distances between a cell's sample points and triangles, many at a time.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>

#include "base/math.hpp"
#include "shaders/touch/contacts/surface_math.h"

namespace palpa::geometry {

/// Sample points of a cell that is about to be divided: the 27 corners of its children (x fastest), then the children's
/// centres.
struct CellSamples {
  static constexpr std::size_t corners = 27, count = 36;  // 35 and one for padding
  alignas(16) std::array<float, count> x, y, z;

  CellSamples(const Vec3& low, double side);
  glm::vec3 at(std::size_t i) const { return {x[i], y[i], z[i]}; }
};

/// The same float arithmetic as shader::surface_distance2, for `count` points, a multiple of 4.
void distances2(const shader::SurfaceTriangle& triangle, const float* x, const float* y, const float* z,
                std::size_t count, float* out);

/// The triangle's point nearest to p. All positions are relative to the solid's centre.
Vec3 nearest_point(const shader::SurfaceTriangle& triangle, const Vec3& p);

inline shader::Float3 float3(const glm::vec3& p) {
  return {p.x, p.y, p.z};
}

}  // namespace palpa::geometry
