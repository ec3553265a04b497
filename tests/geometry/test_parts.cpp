// Hulls, and the surface of unions of them, against counting unit cubes and squares.
#include "geometry/parts/parts.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>
#include <limits>
#include <random>

#include "geometry/parts/convex_hull.hpp"
#include "support/shapes.hpp"
#include "support/thrown.hpp"

namespace palpa::geometry {
namespace {

std::vector<Vec3> cloud(std::uint32_t count, const Vec3& centre, const Vec3& half, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::vector<Vec3> points;
  for (std::uint32_t i = 0; i < count; ++i)
    points.push_back(centre + half * glm::normalize(Vec3(normal(random), normal(random), normal(random))));
  return points;
}

double farthest_out(const Hull& hull, const Vec3& p) {
  double most = -std::numeric_limits<double>::infinity();
  for (const Plane& plane : hull.planes)
    most = std::max(most, glm::dot(plane.normal, p) - plane.offset);
  return most;
}

TEST(ConvexHull, OfACubeIsTheCube) {
  std::vector<Vec3> points{{0.3, 0.2, 0.1}, {0, 0, 1}};  // inside; in a face
  for (int c = 0; c < 8; ++c)
    points.emplace_back(c & 1 ? 1 : -1, c & 2 ? 1 : -1, c & 4 ? 1 : -1);
  const auto hull = convex_hull(points);
  ASSERT_TRUE(hull);
  EXPECT_EQ(hull->planes.size(), 6u);
  EXPECT_EQ(hull->mesh.positions.size(), 8u);
  EXPECT_TRUE(std::equal(hull->mesh.positions.begin(), hull->mesh.positions.end(), points.begin() + 2));
  EXPECT_EQ(hull->mesh.triangles.size(), 12u);
  EXPECT_NEAR(signed_volume(hull->mesh), 8, 1e-12);
  EXPECT_TRUE(find_defects(hull->mesh).closed_and_oriented());
}

TEST(ConvexHull, ContainsEveryPointTightly) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    const Vec3 centre = seed % 2 ? Vec3(0) : Vec3(3, -2, 0.7);
    const auto points = cloud(10 + 40 * seed, centre, Vec3(0.05, 0.02, 0.001 + 0.01 * seed), seed);
    const auto hull = convex_hull(points);
    ASSERT_TRUE(hull) << seed;
    ASSERT_TRUE(find_defects(hull->mesh).closed_and_oriented());
    for (const Vec3& p : points)
      ASSERT_LE(farthest_out(*hull, p), 1e-15);
    // Every triangle lies in its plane.
    for (std::size_t t = 0; t < hull->mesh.triangles.size(); ++t) {
      const Plane& plane = hull->planes[hull->plane_of_triangle[t]];
      for (int corner = 0; corner < 3; ++corner) {
        const Vec3& p = hull->mesh.positions[hull->mesh.triangles[t][corner]];
        ASSERT_NEAR(glm::dot(plane.normal, p), plane.offset, 1e-13);
      }
    }
    const auto again = convex_hull(points);
    EXPECT_EQ(again->mesh.positions, hull->mesh.positions);
    EXPECT_EQ(again->mesh.triangles, hull->mesh.triangles);
  }
}

TEST(ConvexHull, FlatCloudsHaveNoHull) {
  EXPECT_FALSE(convex_hull({}));
  EXPECT_FALSE(convex_hull(std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
  EXPECT_FALSE(convex_hull(std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0.5, 0.2, 0}}));
  EXPECT_FALSE(convex_hull(std::vector<Vec3>(9, Vec3(1, 2, 3))));
  EXPECT_FALSE(convex_hull(std::vector<Vec3>{{0, 0, 0}, {1, 1, 1}, {2, 2, 2}, {3, 3, 3}, {4, 4, 4}}));
  EXPECT_ERROR(convex_hull(std::vector<Vec3>(9, Vec3(std::nan(""), 2, 3))), Exit::failed, "not finite");
}

// ---- unions of boxes with whole corners, so that counting unit cubes is exact ----

using Corner = glm::ivec3;
struct Block {
  Corner low, high;
};
constexpr int side = 9;

/// Unit cubes, by the corner of each that is nearest to the origin.
struct Voxels {
  std::array<bool, side * side * side> full{};
  bool at(const Corner& c) const {
    return glm::all(glm::greaterThanEqual(c, Corner(0))) && glm::all(glm::lessThan(c, Corner(side))) &&
           full[static_cast<std::size_t>((c.z * side + c.y) * side + c.x)];
  }
};

/// Calls `use` for every whole corner from `low`, and below `high` along each axis.
template <typename Use>
void each_corner(const Corner& low, const Corner& high, const Use& use) {
  for (int z = low.z; z < high.z; ++z) {
    for (int y = low.y; y < high.y; ++y) {
      for (int x = low.x; x < high.x; ++x)
        use(Corner(x, y, z));
    }
  }
}

Voxels fill(const std::vector<Block>& blocks) {
  Voxels voxels;
  for (const Block& b : blocks)
    each_corner(b.low, b.high, [&](const Corner& c) {
      voxels.full[static_cast<std::size_t>((c.z * side + c.y) * side + c.x)] = true;
    });
  return voxels;
}

struct Square {
  Vec3 low, high;  // flat along one axis
};
std::vector<Square> surface_of(const Voxels& voxels) {
  std::vector<Square> squares;
  each_corner(Corner(-1), Corner(side), [&](const Corner& c) {
    for (int axis = 0; axis < 3; ++axis) {
      Corner next = c;
      ++next[axis];
      if (voxels.at(c) != voxels.at(next)) squares.push_back({Vec3(next), Vec3(c + 1)});
    }
  });
  return squares;
}

Parts parts_of(const std::vector<Block>& blocks) {
  Parts parts;
  for (const Block& b : blocks)
    parts.parts.push_back(make_part(test::box(Vec3(b.low), Vec3(b.high)).positions).value());
  parts.seam_m = smallest_seam(parts.parts);
  return parts;
}

std::vector<Block> random_blocks(unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> low(0, 5), size(1, 3), count(1, 8);
  std::vector<Block> blocks(static_cast<std::size_t>(count(random)));
  for (Block& b : blocks) {
    b.low = {low(random), low(random), low(random)};
    b.high = b.low + Corner(size(random), size(random), size(random));
  }
  return blocks;
}

TEST(UnionSurface, HasTheAreaAndVolumeOfTheBoxesItIsMadeOf) {
  for (unsigned seed = 0; seed < 300; ++seed) {
    const std::vector<Block> blocks = random_blocks(seed);
    const Voxels voxels = fill(blocks);
    const UnionSurface surface = union_surface(parts_of(blocks));
    const double full = static_cast<double>(std::count(voxels.full.begin(), voxels.full.end(), true));
    ASSERT_NEAR(signed_volume(surface.mesh), full, 1e-4) << seed;
    ASSERT_NEAR(area(surface.mesh), static_cast<double>(surface_of(voxels).size()), 1e-4) << seed;
  }
}

TEST(UnionSurface, IsWhereTheDepthIsMeasuredTo) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> place(-0.5, side + 0.5);
  for (unsigned seed = 0; seed < 40; ++seed) {
    const std::vector<Block> blocks = random_blocks(seed);
    const Voxels voxels = fill(blocks);
    const std::vector<Square> squares = surface_of(voxels);
    const Parts parts = parts_of(blocks);
    const UnionSurface surface = union_surface(parts);
    for (int i = 0; i < 300; ++i) {
      const Vec3 p(place(random), place(random), place(random));
      const Corner cell(glm::floor(p));
      double expected = 0;
      if (voxels.at(cell)) {
        expected = std::numeric_limits<double>::infinity();
        for (const Square& s : squares)
          expected = std::min(expected, glm::distance(glm::clamp(p, s.low, s.high), p));
      }
      ASSERT_NEAR(depth(parts, surface, p), expected, 2e-5) << seed;
    }
  }
}

TEST(UnionSurface, ClosesSeamsUpToTheirWidth) {
  Parts parts;
  parts.parts.push_back(make_part(test::box({0, 0, 0}, {0.01, 0.01, 0.01}).positions).value());
  parts.parts.push_back(make_part(test::box({0.0101, 0, 0}, {0.02, 0.01, 0.01}).positions).value());
  parts.seam_m = 5e-5;
  EXPECT_NEAR(area(union_surface(parts).mesh), 2 * (6e-4 - 1e-4) + 2e-4 - 4e-6 + 2e-4 - 2e-4, 3e-5);
  const double open = area(union_surface(parts).mesh);
  parts.seam_m = 2e-4;
  EXPECT_NEAR(area(union_surface(parts).mesh), open - 2e-4, 1e-7);
}

TEST(UnionSurface, OfRoundPartsHasTheVolumeThatRandomPointsCount) {
  // Three overlapping ellipsoids: volume by counting random points.
  Parts parts;
  parts.parts.push_back(make_part(cloud(120, {0, 0, 0}, {0.03, 0.02, 0.02}, 1)).value());
  parts.parts.push_back(make_part(cloud(90, {0.025, 0.01, 0}, {0.02, 0.02, 0.03}, 2)).value());
  parts.parts.push_back(make_part(cloud(60, {0.01, 0.02, 0.005}, {0.015, 0.02, 0.01}, 3)).value());
  parts.seam_m = smallest_seam(parts.parts);
  std::mt19937 random(7);
  const Vec3 low(-0.04, -0.03, -0.04), extent(0.1, 0.08, 0.08);
  std::uniform_real_distribution<double> unit(0, 1);
  int hits = 0;
  constexpr int tries = 200'000;
  for (int i = 0; i < tries; ++i) {
    const Vec3 p = low + extent * Vec3(unit(random), unit(random), unit(random));
    hits += std::any_of(parts.parts.begin(), parts.parts.end(), [&](const Part& part) { return depth(part, p) > 0; });
  }
  const double expected = extent.x * extent.y * extent.z * hits / tries;
  EXPECT_NEAR(signed_volume(union_surface(parts).mesh) / expected, 1, 0.015);
}

TEST(Parts, APartOfItsOwnPointsIsTheSamePart) {
  const auto points = cloud(80, {1, 2, 3}, Vec3(0.04), 11);
  const Part part = make_part(points).value();
  for (const Vec3& p : part.mesh.positions)
    EXPECT_EQ(p, Vec3(glm::vec3(p)));
  const Part again = make_part(part.mesh.positions).value();
  EXPECT_EQ(again.mesh.positions, part.mesh.positions);
  EXPECT_EQ(again.mesh.triangles, part.mesh.triangles);
  ASSERT_EQ(again.planes.size(), part.planes.size());
  for (std::size_t i = 0; i < part.planes.size(); ++i) {
    EXPECT_EQ(again.planes[i].normal, part.planes[i].normal);
    EXPECT_EQ(again.planes[i].offset, part.planes[i].offset);
  }
}

TEST(UnionSurface, TooManyOverlappingPartsAreRefused) {
  Parts parts;
  for (int i = 0; i < 250; ++i) {
    const Vec3 shift = Vec3(1e-4, 1.3e-4, 0.7e-4) * static_cast<double>(i);
    parts.parts.push_back(*make_part(test::box(shift, Vec3(0.05) + shift).positions));
  }
  EXPECT_CONTAINS(test::error_of([&] { union_surface(parts); }, Exit::failed), "its 250 convex parts overlap so much");
}

}  // namespace
}  // namespace palpa::geometry
