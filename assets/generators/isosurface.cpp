#include "assets/generators/isosurface.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_map>
#include <vector>

namespace palpa::assets {
namespace {

using geometry::Mesh;

/// Six tetrahedra around a cube's main diagonal, as numbers of corners (bit 0: x, 1: y, 2: z), all of one handedness.
/// Every cube is cut in the same way, so neighbours agree on their common face.
constexpr std::array<std::array<int, 4>, 6> kTetrahedra{
    {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7}, {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}}};

/// Even permutations that bring a corner, or a pair of corners, to the front.
constexpr std::array<std::array<int, 4>, 4> kOneFirst{{{0, 1, 2, 3}, {1, 0, 3, 2}, {2, 3, 0, 1}, {3, 2, 1, 0}}};
constexpr std::array<std::array<int, 4>, 6> kTwoFirst{
    {{0, 1, 2, 3}, {0, 2, 3, 1}, {0, 3, 1, 2}, {1, 2, 0, 3}, {1, 3, 2, 0}, {2, 3, 0, 1}}};

constexpr int kBlock = 4;  ///< nodes along the side of a block that is skipped as a whole
constexpr double kSteepest =
    2.0;  ///< largest change of the field per distance between a block's middle and the surface

class March {
 public:
  March(const Field& field, const Box& box, double cell) : low_(box.low), cell_(cell) {
    for (int axis = 0; axis < 3; ++axis)
      count_[axis] = static_cast<int>(std::ceil((box.high[axis] - box.low[axis]) / cell)) + 1;
    values_.resize(static_cast<std::size_t>(count_[0]) * count_[1] * count_[2]);
    for (int z = 0; z < count_[2]; z += kBlock)
      for (int y = 0; y < count_[1]; y += kBlock)
        for (int x = 0; x < count_[0]; x += kBlock)
          sample_block(field, x, y, z);
  }

  Mesh run() {
    for (int z = 0; z + 1 < count_[2]; ++z)
      for (int y = 0; y + 1 < count_[1]; ++y)
        for (int x = 0; x + 1 < count_[0]; ++x)
          add_cube(x, y, z);
    return std::move(mesh_);
  }

 private:
  Vec3 place(int x, int y, int z) const { return low_ + Vec3(x, y, z) * cell_; }
  std::uint32_t node(int x, int y, int z) const {
    return static_cast<std::uint32_t>((static_cast<std::size_t>(z) * count_[1] + y) * count_[0] + x);
  }
  Vec3 place(std::uint32_t node) const {
    const int x = static_cast<int>(node % count_[0]), y = static_cast<int>(node / count_[0] % count_[1]);
    return place(x, y, static_cast<int>(node / count_[0] / count_[1]));
  }
  bool inside(std::uint32_t node) const { return values_[node] < 0.0; }

  /// Samples a block of nodes one by one only if the surface may cross it or its neighbouring edges.
  void sample_block(const Field& field, int x0, int y0, int z0) {
    const double half = 0.5 * (kBlock - 1);
    const double middle = field(low_ + Vec3(x0 + half, y0 + half, z0 + half) * cell_);
    const bool far = std::fabs(middle) > kSteepest * std::sqrt(3.0) * half * cell_;
    for (int z = z0; z < std::min(z0 + kBlock, count_[2]); ++z)
      for (int y = y0; y < std::min(y0 + kBlock, count_[1]); ++y)
        for (int x = x0; x < std::min(x0 + kBlock, count_[0]); ++x)
          values_[node(x, y, z)] = far ? middle : field(place(x, y, z));
  }

  void add_cube(int x, int y, int z) {
    std::array<std::uint32_t, 8> corners{};
    int inner = 0;
    for (int i = 0; i < 8; ++i) {
      corners[i] = node(x + (i & 1), y + (i >> 1 & 1), z + (i >> 2));
      inner += inside(corners[i]) ? 1 : 0;
    }
    if (inner == 0 || inner == 8) return;
    for (const auto& t : kTetrahedra)
      add_tetrahedron({corners[t[0]], corners[t[1]], corners[t[2]], corners[t[3]]});
  }

  void add_tetrahedron(const std::array<std::uint32_t, 4>& n) {
    const int inner = static_cast<int>(std::count_if(n.begin(), n.end(), [&](std::uint32_t i) { return inside(i); }));
    if (inner == 1 || inner == 3) {
      for (const auto& p : kOneFirst) {
        if (inside(n[p[0]]) != (inner == 1)) continue;
        const glm::uvec3 t{vertex(n[p[0]], n[p[1]]), vertex(n[p[0]], n[p[2]]), vertex(n[p[0]], n[p[3]])};
        mesh_.triangles.push_back(inner == 1 ? t : glm::uvec3{t.x, t.z, t.y});
      }
    } else if (inner == 2) {
      for (const auto& p : kTwoFirst) {
        if (!inside(n[p[0]]) || !inside(n[p[1]])) continue;
        const std::uint32_t a = vertex(n[p[0]], n[p[2]]), b = vertex(n[p[0]], n[p[3]]);
        const std::uint32_t c = vertex(n[p[1]], n[p[3]]), d = vertex(n[p[1]], n[p[2]]);
        mesh_.triangles.emplace_back(a, b, c);
        mesh_.triangles.emplace_back(a, c, d);
      }
    }
  }

  /// The surface's vertex on the grid's edge between two nodes, made on first use.
  std::uint32_t vertex(std::uint32_t p, std::uint32_t q) {
    if (p > q) std::swap(p, q);
    const auto [found, is_new] =
        vertices_.try_emplace(std::uint64_t{p} << 32 | q, static_cast<std::uint32_t>(mesh_.positions.size()));
    if (is_new) {
      const double t = std::clamp(values_[p] / (values_[p] - values_[q]), 0.1, 0.9);
      mesh_.positions.push_back(place(p) + (place(q) - place(p)) * t);
    }
    return found->second;
  }

  Vec3 low_;
  double cell_;
  std::array<int, 3> count_{};
  std::vector<double> values_;
  std::unordered_map<std::uint64_t, std::uint32_t> vertices_;
  Mesh mesh_;
};

}  // namespace

Mesh isosurface(const Field& field, const Box& box, double cell) {
  return March(field, box, cell).run();
}

}  // namespace palpa::assets
