#include "geometry/rigid_copies.hpp"

#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <map>
#include <numeric>

namespace palpa::geometry {
namespace {

/// Equal for transforms that differ by a rigid motion: the products of their columns, in single precision, and their
/// handedness.
using Shape = std::array<std::int64_t, 9>;

Shape shape_of(const CopyOf& copy) {
  const glm::dmat3 M(copy.T_world_mesh);
  const glm::dmat3 gram = glm::transpose(M) * M;
  const double size = gram[0][0] + gram[1][1] + gram[2][2];
  int exponent = 0;
  const double mantissa = std::frexp(size, &exponent);
  // Copies that differ by a few units of rounding may fall on either side of a step: then each is prepared separately.
  constexpr double steps = 1 << 24;
  const auto rounded = [&](double value) { return std::llround(value * steps); };
  return {copy.mesh,
          glm::determinant(M) < 0 ? 1 : 0,
          exponent,
          rounded(mantissa),
          rounded(gram[0][0] / size),
          rounded(gram[1][1] / size),
          rounded(gram[0][1] / size),
          rounded(gram[0][2] / size),
          rounded(gram[1][2] / size)};
}

}  // namespace

std::vector<std::uint32_t> find_rigid_copies(const Scene& scene) {
  std::vector<std::uint32_t> first(scene.meshes.size()), alone(scene.meshes.size());
  std::iota(first.begin(), first.end(), 0U);
  std::iota(alone.begin(), alone.end(), 0U);
  std::map<Shape, std::uint32_t> known;
  std::uint64_t spared = 0;
  for (std::uint32_t i = 0; i < first.size(); ++i) {
    const SceneMesh& mesh = scene.meshes[i];
    if (!mesh.copy || !mesh.haptics.touchable || mesh.part) continue;
    const auto [place, fresh] = known.try_emplace(shape_of(*mesh.copy), i);
    if (fresh) continue;
    first[i] = place->second;
    spared += mesh.mesh.triangles.size() + copy_overhead;
  }
  return spared > worth_sharing ? first : alone;
}

std::vector<std::uint32_t> vertices_of(const Mesh& original, const Mesh& made) {
  std::vector<Vec3> all = original.positions;
  all.insert(all.end(), made.positions.begin(), made.positions.end());
  std::vector<std::uint32_t> index = weld_indices(all);
  index.erase(index.begin(), index.begin() + static_cast<std::ptrdiff_t>(original.positions.size()));
  for (const std::uint32_t v : index) {
    if (v >= original.positions.size()) return {};
  }
  return index;
}

Plane moved(const Plane& plane, const Transform& T) {
  const Vec3 normal = glm::normalize(glm::dmat3(T) * plane.normal);
  return {normal, glm::dot(normal, transform_point(T, plane.normal * plane.offset))};
}

}  // namespace palpa::geometry
