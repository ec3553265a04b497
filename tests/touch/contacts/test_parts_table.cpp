// The table's depth in single precision, cell by cell, against double precision over all parts and triangles.
#include "touch/contacts/parts_table.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>
#include <random>

#include "base/error.hpp"
#include "support/thrown.hpp"
#include "touch/harness.hpp"

namespace palpa::touch::test {
namespace {

using geometry::InternalFaces;
using geometry::Parts;

std::vector<Vec3> corners(const Vec3& low, const Vec3& high) {
  std::vector<Vec3> points;
  for (int c = 0; c < 8; ++c)
    points.emplace_back(c & 1 ? high.x : low.x, c & 2 ? high.y : low.y, c & 4 ? high.z : low.z);
  return points;
}

/// Hulls of random clouds, each reaching into some of the others: a lump, such as decompositions give.
Parts lump(std::uint32_t count, double size, const Vec3& centre, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> unit(0.3, 1);
  Parts parts;
  while (parts.parts.size() < count) {
    const Vec3 middle = centre + 0.5 * size * Vec3(normal(random), normal(random), normal(random)) * 0.7;
    const Vec3 half = 0.5 * size * Vec3(unit(random), unit(random), unit(random)) * 0.6;
    std::vector<Vec3> cloud;
    for (int i = 0; i < 40; ++i)
      cloud.push_back(middle + half * glm::normalize(Vec3(normal(random), normal(random), normal(random))));
    parts.parts.push_back(geometry::make_part(cloud).value());
  }
  parts.seam_m = geometry::smallest_seam(parts.parts);
  return parts;
}

Box bounds_of(const Parts& parts) {
  Box box;
  for (const geometry::Part& part : parts.parts) {
    box.add(part.bounds.low);
    box.add(part.bounds.high);
  }
  return box;
}

/// Paper's Eq. (1) for each part: the least depth over the parts that hold the point.
double eq1(const Parts& parts, const Vec3& p) {
  double least = std::numeric_limits<double>::infinity();
  for (const geometry::Part& part : parts.parts) {
    const double d = geometry::depth(part, p);
    if (d > 0) least = std::min(least, d);
  }
  return std::isfinite(least) ? least : 0;
}

void expect_depths(const Parts& parts, InternalFaces faces, std::uint32_t count, double tolerance) {
  std::vector<shader::uvec4> words;
  const PartsGrid grid = add_parts(words, parts, faces);
  const geometry::UnionSurface surface = geometry::union_surface(parts);
  const Box box = bounds_of(parts);
  const Vec3 margin = 0.05 * (box.high - box.low);
  std::uint32_t inside = 0, undecided = 0;
  for (const glm::vec3& point : random_points(count, box.low - margin, box.high + margin, 3)) {
    const Vec3 p(point);
    const double expected = faces == InternalFaces::keep ? eq1(parts, p) : geometry::depth(parts, surface, p);
    const float found = parts_depth(words, grid, point, std::numeric_limits<float>::infinity());
    // Within rounding of some part's surface the sides may differ.
    const bool close = std::any_of(parts.parts.begin(), parts.parts.end(), [&](const geometry::Part& part) {
      return std::abs(geometry::depth(part, p)) < tolerance;
    });
    if (close) {
      ++undecided;
      continue;
    }
    ASSERT_NEAR(found, expected, tolerance) << point.x << ' ' << point.y << ' ' << point.z;
    inside += expected > 0;
    // A limit may only make deep points vanish.
    const float limited = parts_depth(words, grid, point, 1.5e-3F);
    if (expected < 1.5e-3) {
      ASSERT_EQ(limited, found);
    } else {
      ASSERT_TRUE(limited == 0 || limited == found);
    }
  }
  EXPECT_GT(inside, count / 20);
  EXPECT_LT(undecided, count / 20);
}

TEST(PartsTable, GivesTheDepthBelowTheUnionOfBoxes) {
  Parts parts;
  parts.parts.push_back(geometry::make_part(corners({0, 0, 0}, {0.04, 0.04, 0.04})).value());
  parts.parts.push_back(geometry::make_part(corners({0.02, 0, 0}, {0.06, 0.04, 0.04})).value());  // overlaps
  parts.parts.push_back(geometry::make_part(corners({0.06, 0, 0}, {0.08, 0.02, 0.04})).value());  // abuts
  parts.parts.push_back(geometry::make_part(corners({0, 0.04, 0}, {0.01, 0.05, 0.01})).value());  // abuts in a corner
  parts.seam_m = geometry::smallest_seam(parts.parts);
  expect_depths(parts, InternalFaces::drop, 20'000, 1e-6);
  expect_depths(parts, InternalFaces::keep, 20'000, 1e-6);
}

TEST(PartsTable, GivesTheDepthBelowALump) {
  for (const std::uint32_t count : {1U, 5U, 24U}) {
    const Parts parts = lump(count, 0.08, {0.3, -0.1, 0.05}, count);
    expect_depths(parts, InternalFaces::drop, 3'000, 1e-6);
    expect_depths(parts, InternalFaces::keep, 3'000, 1e-6);
  }
}

TEST(PartsTable, KnowsThatACutIsInside) {
  Parts parts;
  parts.parts.push_back(geometry::make_part(corners({-0.02, 0, 0}, {0, 0.04, 0.04})).value());
  parts.parts.push_back(geometry::make_part(corners({0, 0, 0}, {0.02, 0.04, 0.04})).value());
  parts.seam_m = geometry::smallest_seam(parts.parts);
  std::vector<shader::uvec4> words;
  const PartsGrid grid = add_parts(words, parts, InternalFaces::drop);
  // Exactly on the cut, a millimetre below the top.
  EXPECT_NEAR(parts_depth(words, grid, {0, 0.039F, 0.02F}, 1), 1e-3, 1e-7);
  EXPECT_EQ(parts_depth(words, grid, {0, 0.041F, 0.02F}, 1), 0);
  EXPECT_EQ(parts_depth(words, grid, {0.03F, 0.02F, 0.02F}, 1), 0);
}

TEST(PartsTable, ListsFewTrianglesWhereTheShellIs) {
  const Parts parts = lump(40, 0.1, {0, 0, 0}, 9);
  std::vector<shader::uvec4> words;
  const PartsGrid grid = add_parts(words, parts, InternalFaces::drop);
  std::uint64_t listed = 0, cells = 0;
  for (std::uint32_t c = 0; c < grid.cells_per_axis * grid.cells_per_axis * grid.cells_per_axis; ++c) {
    const std::size_t at = grid.base + 1 + 2 * std::size_t{c};
    const float least = std::bit_cast<float>(words[at + 1].x);
    if (words[at].y == 0 || least > 1.5e-3F) continue;
    listed += words[at].w;
    ++cells;
  }
  EXPECT_LT(static_cast<double>(listed) / static_cast<double>(cells), 60);
  EXPECT_LT(words.size() * sizeof(shader::uvec4), std::size_t{100} << 20);
}

TEST(PartsTable, RefusesPartsThatAreNone) {
  std::vector<shader::uvec4> words;
  EXPECT_ERROR(add_parts(words, {}, InternalFaces::drop), Exit::usage, "part has no planes");
  Parts broken = lump(2, 0.05, {0, 0, 0}, 1);
  broken.parts[1].planes[3].offset = std::nan("");
  EXPECT_ERROR(add_parts(words, broken, InternalFaces::drop), Exit::usage, "part has no planes");
}

}  // namespace
}  // namespace palpa::touch::test
