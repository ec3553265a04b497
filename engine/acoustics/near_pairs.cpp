#include "acoustics/near_pairs.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>

#include "acoustics/triangle_rules.hpp"
#include "base/activity.hpp"
#include "base/parallel.hpp"

namespace palpa::acoustics {
namespace {

using geometry::Mesh;

/// Patches whose centroids are nearer than so many times their mean longest side are sampled more closely: above 4/3,
/// so that those that touch are among them.
constexpr double reach = 2.2;
/// Nearer than that, more closely still.
constexpr double close_reach = 1.3;
/// Gauss points per variable for patches that touch.
constexpr std::size_t touching_points = 3;
constexpr std::size_t patches_per_job = 64;

/// Barycentric coordinates of (u, v), taken from corners that begin with `first` and run on (or back) to the patch's
/// own.
std::array<double, 2> turned(double u, double v, std::uint32_t first, bool back) {
  std::array<double, 3> own{};
  const std::array<double, 3> from{1 - u - v, u, v};
  for (std::uint32_t i = 0; i < 3; ++i)
    own[(first + (back ? 3 - i : i)) % 3] = from[i];
  return {own[1], own[2]};
}

void add(PairTable& table, std::array<double, 2> a, std::array<double, 2> b, double weight) {
  table.u.push_back(static_cast<float>(a[0]));
  table.v.push_back(static_cast<float>(a[1]));
  table.other_u.push_back(static_cast<float>(b[0]));
  table.other_v.push_back(static_cast<float>(b[1]));
  table.weight.push_back(static_cast<float>(weight));
}

void pad(PairTable& table) {
  while (table.size() % far_lanes != 0)
    add(table, {0.1, 0.1}, {0.7, 0.2}, 0);
}

PairTable touching_table(Touch touch, std::uint32_t first, std::uint32_t other_first) {
  PairTable table;
  for (const PairSample& s : touching_rule(touch, touching_points)) {
    add(table, turned(s.u, s.v, first, false), turned(s.other_u, s.other_v, other_first, touch == Touch::edge),
        s.weight);
  }
  pad(table);
  return table;
}

PairTable product_table(std::span<const TriangleSample> rule) {
  PairTable table;
  for (const TriangleSample& a : rule) {
    for (const TriangleSample& b : rule)
      add(table, {a.u, a.v}, {b.u, b.v}, a.weight * b.weight);
  }
  pad(table);
  return table;
}

/// The six-point rule on four quarters of the triangle.
std::vector<TriangleSample> quartered() {
  std::vector<TriangleSample> rule;
  for (const TriangleSample& s : six_point_rule()) {
    const double u = s.u / 2, v = s.v / 2, weight = s.weight / 4;
    rule.push_back({u, v, weight});
    rule.push_back({u + 0.5, v, weight});
    rule.push_back({u, v + 0.5, weight});
    rule.push_back({0.5 - u, 0.5 - v, weight});
  }
  return rule;
}

struct Tables {
  PairTable same = touching_table(Touch::same, 0, 0);
  PairTable edge[3][3], corner[3][3];
  PairTable near = product_table(six_point_rule()), close = product_table(quartered());
  Tables() {
    for (std::uint32_t a = 0; a < 3; ++a) {
      for (std::uint32_t b = 0; b < 3; ++b) {
        // The neighbour runs along a shared side the other way: its table starts where this side ends.
        edge[a][b] = touching_table(Touch::edge, a, (b + 1) % 3);
        corner[a][b] = touching_table(Touch::corner, a, b);
      }
    }
  }
  const PairTable& of(const glm::uvec3& a, const glm::uvec3& b, bool very_close) const {
    std::array<std::array<std::uint32_t, 2>, 3> shared{};
    std::size_t count = 0;
    for (std::uint32_t i = 0; i < 3; ++i) {
      for (std::uint32_t j = 0; j < 3; ++j) {
        if (a[static_cast<int>(i)] == b[static_cast<int>(j)]) shared[count++] = {i, j};
      }
    }
    if (count == 3) return same;
    if (count == 2) {
      // Of the two shared corners the side's first is the one whose next is the other.
      const std::size_t start = (shared[0][0] + 1) % 3 == shared[1][0] ? 0 : 1;
      return edge[shared[start][0]][shared[1 - start][1]];
    }
    if (count == 1) return corner[shared[0][0]][shared[0][1]];
    return very_close ? close : near;
  }
};

struct Ball {
  Vec3 centre;
  double size;  // longest side
};

std::vector<Ball> balls(const Mesh& mesh) {
  std::vector<Ball> made;
  made.reserve(mesh.triangles.size());
  for (const glm::uvec3& t : mesh.triangles) {
    const Vec3 &a = mesh.positions[t.x], &b = mesh.positions[t.y], &c = mesh.positions[t.z];
    made.push_back({(a + b + c) / 3.0, std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)})});
  }
  return made;
}

/// Whether patches are nearer than `times` the mean of their sizes.
bool within(const Ball& a, const Ball& b, double times) {
  const Vec3 way = a.centre - b.centre;
  const double most = 0.5 * times * (a.size + b.size);
  return glm::dot(way, way) < most * most;
}

void find_pairs(const std::vector<Ball>& ball, NearPairs& pairs) {
  std::vector<std::vector<std::uint32_t>> found(ball.size());
  parallel_chunks(ball.size(), patches_per_job, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      for (std::uint32_t other = 0; other < ball.size(); ++other) {
        if (within(ball[t], ball[other], reach)) found[t].push_back(other);
      }
    }
  });
  pairs.first.push_back(0);
  for (const std::vector<std::uint32_t>& trials : found) {
    pairs.trial.insert(pairs.trial.end(), trials.begin(), trials.end());
    pairs.first.push_back(static_cast<std::uint32_t>(pairs.trial.size()));
  }
}

NearPatch relative(const Patch& patch, const Vec3& origin) {
  NearPatch out;
  for (std::size_t i = 0; i < 6; ++i) {
    const Vec3 c = i == 0 ? patch.c[0] - origin : patch.c[i];
    for (int axis = 0; axis < 3; ++axis)
      out.c[i][axis] = static_cast<float>(c[axis]);
  }
  return out;
}

/// Half of the hat functions' products over a patch.
Block half_of_itself(const Patch& patch) {
  Block block{};
  for (const TriangleSample& s : six_point_rule()) {
    const std::array<double, 3> hat{1 - s.u - s.v, s.u, s.v};
    const double area = s.weight * glm::length(patch.area_vector(s.u, s.v));
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t j = 0; j < 3; ++j)
        block[3 * i + j] += static_cast<float>(0.5 * hat[i] * hat[j] * area);
    }
  }
  return block;
}

}  // namespace

NearPairs near_pairs(const Patches& body, double wave_number) {
  static const Tables tables;
  const Mesh& mesh = body.mesh;
  const std::vector<Ball> ball = balls(mesh);
  NearPairs pairs;
  find_pairs(ball, pairs);
  pairs.blocks.resize(pairs.trial.size());
  Activity activity("samples neighbouring faces", mesh.triangles.size());
  parallel_chunks(mesh.triangles.size(), patches_per_job, [&](std::size_t, std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      const NearPatch test = relative(body.patches[t], ball[t].centre);
      for (std::uint32_t entry = pairs.first[t]; entry < pairs.first[t + 1]; ++entry) {
        const std::uint32_t other = pairs.trial[entry];
        if (other < t) continue;  // done with it, from its side
        const PairTable& table =
            tables.of(mesh.triangles[t], mesh.triangles[other], within(ball[t], ball[other], close_reach));
        Block exchanged;
        near_blocks(test, relative(body.patches[other], ball[t].centre), table, static_cast<float>(wave_number),
                    pairs.blocks[entry], exchanged);
        if (other == t) {
          const Block half = half_of_itself(body.patches[t]);
          for (std::size_t i = 0; i < half.size(); ++i)
            pairs.blocks[entry][i] += half[i];
        } else {
          const auto from = pairs.trial.begin() + pairs.first[other], to = pairs.trial.begin() + pairs.first[other + 1];
          const auto mirror = std::lower_bound(from, to, static_cast<std::uint32_t>(t)) - pairs.trial.begin();
          pairs.blocks[static_cast<std::size_t>(mirror)] = exchanged;
        }
      }
    }
    activity.advance(end - begin);
  });
  return pairs;
}

}  // namespace palpa::acoustics
