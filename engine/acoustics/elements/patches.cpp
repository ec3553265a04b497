#include "acoustics/elements/patches.hpp"

#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

#include "geometry/mesh/topology.hpp"

namespace palpa::acoustics {
namespace {

using geometry::Mesh;

std::uint32_t next(std::uint32_t side) {
  return side % 3 == 2 ? side - 2 : side + 1;
}

Vec3 start(const Mesh& mesh, std::uint32_t side) {
  return mesh.positions[geometry::side_vertices(mesh, side)[0]];
}

std::vector<std::uint8_t> find_sharp(const Mesh& mesh, const std::vector<std::uint32_t>& twin) {
  std::vector<Vec3> normals(mesh.triangles.size());
  for (std::uint32_t t = 0; t < normals.size(); ++t)
    normals[t] = glm::normalize(geometry::area_vector(mesh, t));
  std::vector<std::uint8_t> sharp(twin.size());
  const double least = std::cos(sharp_turn);
  for (std::uint32_t side = 0; side < twin.size(); ++side)
    sharp[side] = glm::dot(normals[side / 3], normals[twin[side] / 3]) < least;
  return sharp;
}

/// The normal of each corner, numbered as the sides that start there. Faces around a vertex share its normal unless a
/// sharp edge separates them.
std::vector<Vec3> corner_normals(const Mesh& mesh, const std::vector<std::uint32_t>& twin,
                                 const std::vector<std::uint8_t>& sharp) {
  geometry::UnionFind fans(twin.size());
  for (std::uint32_t side = 0; side < twin.size(); ++side) {
    if (!sharp[side]) fans.join(side, next(twin[side]));
  }
  std::vector<Vec3> normals(twin.size(), Vec3(0));
  for (std::uint32_t side = 0; side < twin.size(); ++side) {
    const Vec3 here = start(mesh, side);
    const Vec3 a = start(mesh, next(side)) - here, b = start(mesh, next(next(side))) - here;
    normals[fans.find(side)] += glm::cross(a, b) / (glm::dot(a, a) * glm::dot(b, b));
  }
  for (std::uint32_t side = 0; side < twin.size(); ++side)
    normals[side] = normals[fans.find(side)];
  for (Vec3& normal : normals) {
    const double length = glm::length(normal);
    normal = length > 0 ? normal / length : Vec3(0);
  }
  return normals;
}

/// The part of a side's bulge that the normal at one of its ends asks for. `lean` is the sine of the angle by which the
/// normal leans away from the perpendicular of the chord, outwards for a bulge outwards.
Vec3 bulge_of_end(const Vec3& along, const Vec3& normal, double lean) {
  const Vec3 across = normal - glm::dot(normal, along) * along;
  const double length = glm::length(across);
  // An arc whose end leans by the angle a bulges by half the chord times tan(a / 2) = sin(a) / (1 + cos(a)).
  return length > 0 ? across * (0.25 * lean / (length * (1 + length))) : Vec3(0);
}

/// The offset of the middle of a side from `a` to `b` from the middle of its chord.
Vec3 bulge(const Vec3& a, const Vec3& b, const Vec3& normal_a, const Vec3& normal_b) {
  const double chord = glm::length(b - a);
  const Vec3 along = (b - a) / chord;
  const Vec3 out = bulge_of_end(along, normal_a, -glm::dot(along, normal_a)) +
                   bulge_of_end(along, normal_b, glm::dot(along, normal_b));
  // An arc of a hundred degrees bulges by 0.233 of its chord; a larger estimate is meaningless.
  constexpr double most = 0.233;
  const double length = glm::length(out);
  return chord * (length > most ? out * (most / length) : out);
}

}  // namespace

Patches make_patches(geometry::Mesh mesh) {
  Patches made;
  made.twin = geometry::twins(mesh);
  made.sharp = find_sharp(mesh, made.twin);
  const std::vector<Vec3> normals = corner_normals(mesh, made.twin, made.sharp);
  made.patches.resize(mesh.triangles.size());
  for (std::uint32_t t = 0; t < made.patches.size(); ++t) {
    std::array<Vec3, 3> corner;
    std::array<Vec3, 3> bulges{};  // of the sides 0-1, 1-2, 2-0
    for (std::uint32_t i = 0; i < 3; ++i)
      corner[i] = start(mesh, 3 * t + i);
    for (std::uint32_t i = 0; i < 3; ++i) {
      const std::uint32_t j = (i + 1) % 3;
      if (!made.sharp[3 * t + i]) bulges[i] = bulge(corner[i], corner[j], normals[3 * t + i], normals[3 * t + j]);
    }
    // Sums of the corners' barycentric coordinates and four times their products, which are 1 in the middles of the
    // sides.
    const Vec3 b01 = 4.0 * bulges[0], b12 = 4.0 * bulges[1], b20 = 4.0 * bulges[2];
    made.patches[t].c = {corner[0], corner[1] - corner[0] + b01, corner[2] - corner[0] + b20, -b01, b12 - b01 - b20,
                         -b20};
  }
  made.mesh = std::move(mesh);
  return made;
}

}  // namespace palpa::acoustics
