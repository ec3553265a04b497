#include "acoustics/boundary/far_tables.hpp"

#include <array>
#include <glm/geometric.hpp>

#include "acoustics/elements/triangle_rules.hpp"

namespace palpa::acoustics {

std::vector<FarPatch> far_patches(const Patches& body, const Vec3& origin) {
  std::vector<FarPatch> patches(body.patches.size());
  for (std::size_t t = 0; t < patches.size(); ++t) {
    const Patch& patch = body.patches[t];
    for (std::size_t q = 0; q < 3; ++q) {
      const TriangleSample& s = three_point_rule()[q];
      const std::array<Vec3, 4> numbers{patch.at(s.u, s.v) - origin, s.weight * patch.area_vector(s.u, s.v),
                                        s.weight * patch.along_u(s.u, s.v), s.weight * patch.along_v(s.u, s.v)};
      patches[t].area[q] = static_cast<float>(glm::length(numbers[1]));
      for (std::size_t i = 0; i < far_numbers; ++i)
        patches[t].of[q][i] = static_cast<float>(numbers[i / 3][static_cast<int>(i % 3)]);
    }
  }
  return patches;
}

void gather(std::span<const FarPatch> patches, std::span<const std::uint32_t> selected, std::vector<FarGroup>& groups) {
  groups.resize((selected.size() + far_lanes - 1) / far_lanes);
  for (std::size_t at = 0; at < groups.size() * far_lanes; ++at) {
    FarGroup& group = groups[at / far_lanes];
    const std::size_t lane = at % far_lanes;
    for (std::size_t q = 0; q < 3; ++q) {
      for (std::size_t i = 0; i < far_numbers; ++i)
        group.of[q][i][lane] = at < selected.size() ? patches[selected[at]].of[q][i] : i < far_area ? 1e3F : 0.0F;
    }
  }
}

Around patches_around(const geometry::Mesh& mesh) {
  Around around;
  around.first.assign(mesh.positions.size() + 1, 0);
  for (const glm::uvec3& t : mesh.triangles) {
    for (int c = 0; c < 3; ++c)
      ++around.first[t[c] + 1];
  }
  for (std::size_t v = 0; v < mesh.positions.size(); ++v)
    around.first[v + 1] += around.first[v];
  around.patches.resize(3 * mesh.triangles.size());
  std::vector<std::uint32_t> next(around.first.begin(), around.first.end() - 1);
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    for (int c = 0; c < 3; ++c)
      around.patches[next[mesh.triangles[t][c]]++] = t;
  }
  return around;
}

}  // namespace palpa::acoustics
