// The vector kernels that fill a surface's lists, against the definitions written out.
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <limits>
#include <random>
#include <vector>

#include "geometry/surface/surface_contest.hpp"
#include "geometry/surface/surface_keep.hpp"
#include "geometry/surface/surface_samples.hpp"

namespace palpa::test {
namespace {

using namespace geometry;

class Draw {
 public:
  float number() { return std::uniform_real_distribution<float>(-1, 1)(random_); }
  Vec3 point() { return {number(), number(), number()}; }

  /// As make_surface_triangles lays one out: on axes of its own, with the directions and lengths of its sides.
  shader::SurfaceTriangle triangle() {
    const Vec3 a = point(), b = a + 0.3 * point(), c = a + 0.3 * point();
    const Vec3 x = glm::normalize(b - a), normal = glm::normalize(glm::cross(b - a, c - a)), y = glm::cross(normal, x);
    const Vec2 end(glm::length(b - a), 0), top(glm::dot(c - a, x), glm::dot(c - a, y));
    const Vec2 to_top = glm::normalize(top - end), to_start = -glm::normalize(top);
    const auto f = [](double value) { return static_cast<float>(value); };
    return {{f(a.x), f(a.y), f(a.z), f(end.x)},
            {f(normal.x), f(normal.y), f(normal.z), f(to_top.x)},
            {f(x.x), f(x.y), f(x.z), f(to_top.y)},
            {f(glm::length(top - end)), f(to_start.x), f(to_start.y), f(glm::length(top))}};
  }

 private:
  std::mt19937 random_{7};
};

TEST(SurfaceLists, DistancesHaveTheBitsOfTheShadersDefinition) {
  Draw draw;
  constexpr std::size_t n = CellSamples::count;
  std::size_t zero = 0, inside = 0;
  for (int i = 0; i < 2000; ++i) {
    const shader::SurfaceTriangle triangle = draw.triangle();
    const CellSamples samples(draw.point(), i % 3 == 0 ? 0.01 : 0.5);
    std::array<float, n> d;
    distances2(triangle, samples.x.data(), samples.y.data(), samples.z.data(), n, d.data());
    for (std::size_t k = 0; k < n; ++k) {
      const float expected = shader::surface_distance2(triangle, float3(samples.at(k)));
      ASSERT_EQ(std::memcmp(&d[k], &expected, sizeof(expected)), 0) << i << ' ' << k << ' ' << d[k] << ' ' << expected;
      const shader::SurfaceFeature feature =
          shader::surface_feature(triangle, shader::on_axes(triangle, float3(samples.at(k))));
      (feature.side == 3 ? inside : zero) += 1;
    }
  }
  // Both kinds of answer were asked for.
  EXPECT_GT(inside, 500U);
  EXPECT_GT(zero, 500U);
}

/// Contest::beats as its definition says it.
bool beaten(const Contest& contest, const std::array<float, 8>& d) {
  for (std::size_t r = 0; r < contest.count; ++r) {
    float least = std::numeric_limits<float>::max();
    for (std::size_t c = 0; c < 8; ++c)
      least = std::min(least, d[c] - contest.to_corner[r][c]);
    if (least > contest.margin[r]) return true;
  }
  return false;
}

TEST(SurfaceLists, KeepWhatNoRivalBeatsAndInOrder) {
  Draw draw;
  constexpr std::size_t n = CellSamples::count, many = 40;
  std::size_t all_kept = 0, saved = 0;
  for (int round = 0; round < 400; ++round) {
    const CellSamples samples(draw.point(), 0.2);
    std::vector<shader::SurfaceTriangle> triangles;
    std::vector<std::uint32_t> list;
    std::vector<float> d2(many * n);
    for (std::uint32_t k = 0; k < many; ++k) {
      triangles.push_back(draw.triangle());
      list.push_back(3 * k + 1);
      distances2(triangles[k], samples.x.data(), samples.y.data(), samples.z.data(), n, d2.data() + k * n);
    }
    for (std::size_t child = 0; child < 8; ++child) {
      const std::size_t corner = (child & 1) + (child >> 1 & 1) * 3 + (child >> 2) * 9;
      Corners corners;
      std::array<std::size_t, 8> at;
      for (std::size_t c = 0; c < 8; ++c) {
        at[c] = corner + (c & 1) + (c >> 1 & 1) * 3 + (c >> 2) * 9;
        corners[c] = samples.at(at[c]);
      }
      const double slack = round % 2 == 0 ? 0 : 0.05;
      Contest contest;
      for (const std::uint32_t k : {0U, 5U, 9U, 5U})
        contest.add({nearest_point(triangles[k], Vec3(samples.at(27 + child))), list[k]}, corners, 1e-7, slack);
      EXPECT_EQ(contest.count, 3U);
      std::vector<std::uint32_t> expected{99};
      for (std::uint32_t k = 0; k < many; ++k) {
        std::array<float, 8> d;
        for (std::size_t c = 0; c < 8; ++c)
          d[c] = d2[k * n + at[c]];
        const bool lost = beaten(contest, d), rival = k == 0 || k == 5 || k == 9;
        EXPECT_EQ(contest.beats(d), lost);
        if (!lost || (slack > 0 && rival)) expected.push_back(list[k]);
        saved += lost && slack > 0 && rival ? 1 : 0;
      }
      std::vector<std::uint32_t> kept{99};  // what is there stays
      const std::uint32_t count = keep_unbeaten(contest, slack > 0, list, d2.data() + corner, n, kept);
      EXPECT_EQ(kept, expected);
      EXPECT_EQ(count + 1, kept.size());
      all_kept += count;
    }
  }
  EXPECT_GT(all_kept, 400U * 8);
  EXPECT_LT(all_kept, 400U * 8 * many / 2);
  EXPECT_GT(saved, 0U);
}

}  // namespace
}  // namespace palpa::test
