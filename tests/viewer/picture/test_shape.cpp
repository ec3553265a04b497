#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <glm/geometric.hpp>
#include <numbers>

#include "geometry/mesh/icosphere.hpp"
#include "viewer/picture/shape.hpp"
#include "viewer/scenes.hpp"

namespace palpa::viewer {
namespace {

Vec3 xyz(const shader::vec4& v) {
  return {v.x, v.y, v.z};
}

std::size_t creases(const Shape& shape) {
  return shape.edges.creases.size();
}

TEST(Shape, ACubeHasTwelveCreasesAndFlatFaces) {
  const Shape shape = make_shape(test::box({-1, -1, -1}, {1, 1, 1}));
  EXPECT_EQ(shape.vertices.size(), 24u);  // four for each face
  EXPECT_EQ(shape.corners.size(), 36u);
  EXPECT_EQ(creases(shape), 12u);
  EXPECT_TRUE(shape.edges.folds.empty());  // the faces' diagonals are not edges
  for (const auto& v : shape.vertices) {
    EXPECT_NEAR(std::max({std::abs(v.normal.x), std::abs(v.normal.y), std::abs(v.normal.z)}), 1, 1e-6);
    EXPECT_GT(glm::dot(xyz(v.normal), xyz(v.position)), 0.9);  // outwards
  }
}

TEST(Shape, AFineCylinderIsSmoothAroundAndSharpAtItsRims) {
  constexpr unsigned n = 40;
  geometry::Mesh mesh;
  for (unsigned i = 0; i < n; ++i) {
    const double a = 2 * std::numbers::pi * i / n;
    mesh.positions.emplace_back(std::cos(a), 0, std::sin(a));
    mesh.positions.emplace_back(std::cos(a), 1, std::sin(a));
  }
  mesh.positions.emplace_back(0, 0, 0);
  mesh.positions.emplace_back(0, 1, 0);
  for (unsigned i = 0; i < n; ++i) {
    const unsigned a = 2 * i, b = 2 * ((i + 1) % n);
    mesh.triangles.push_back({a, a + 1, b});
    mesh.triangles.push_back({b, a + 1, b + 1});
    mesh.triangles.push_back({2 * n, a, b});
    mesh.triangles.push_back({2 * n + 1, b + 1, a + 1});
  }
  const Shape shape = make_shape(mesh);
  EXPECT_EQ(creases(shape), 2 * n);
  EXPECT_EQ(shape.edges.folds.size(), n);  // the vertical ones, for the outline
  for (const auto& v : shape.vertices) {
    if (std::abs(v.normal.y) < 0.5) {  // on the side: radial
      EXPECT_NEAR(glm::distance(xyz(v.normal), Vec3(v.position.x, 0, v.position.z)), 0, 0.06);
    }
  }
}

// A ball with a scanner's error at one place: the fold exists, but no line must be drawn there.
TEST(Shape, ShortFoldsThatEndAreNoCreases) {
  constexpr unsigned rings = 24, segments = 48;
  const auto ball_with_bump = [](double height) {
    geometry::Mesh mesh;
    for (unsigned r = 1; r < rings; ++r) {
      for (unsigned s = 0; s < segments; ++s) {
        const double a = std::numbers::pi * r / rings, b = 2 * std::numbers::pi * s / segments;
        mesh.positions.emplace_back(std::sin(a) * std::cos(b), std::cos(a), -std::sin(a) * std::sin(b));
      }
    }
    const auto at = [](unsigned r, unsigned s) { return (r - 1) * segments + s % segments; };
    const auto top = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.emplace_back(0, 1, 0);
    mesh.positions.emplace_back(0, -1, 0);
    for (unsigned s = 0; s < segments; ++s) {
      mesh.triangles.push_back({top, at(1, s), at(1, s + 1)});
      mesh.triangles.push_back({top + 1, at(rings - 1, s + 1), at(rings - 1, s)});
      for (unsigned r = 1; r + 1 < rings; ++r) {
        mesh.triangles.push_back({at(r, s), at(r + 1, s), at(r, s + 1)});
        mesh.triangles.push_back({at(r, s + 1), at(r + 1, s), at(r + 1, s + 1)});
      }
    }
    for (unsigned s = 5; s < 7; ++s)
      mesh.positions[at(12, s)] *= 1 + height;
    return mesh;
  };
  std::ptrdiff_t folds = 0;
  for (double height = 0; folds == 0 && height < 0.2; height += 0.002) {
    const Shape shape = make_shape(ball_with_bump(height));
    const auto normal = [&](std::uint32_t face) { return xyz(shape.edges.planes[face]); };
    folds = std::ranges::count_if(shape.edges.folds, [&](const EdgeNet::Fold& fold) {
      return glm::dot(normal(fold.left), normal(fold.right)) <= std::cos(0.52);
    });
    EXPECT_EQ(creases(shape), 0u);
  }
  EXPECT_GT(folds, 0);
}

// As many triangles as in a scan: hardly more vertices than places, and neighbouring triangles share them.
TEST(Shape, ASmoothMeshHasOneVertexForEachPlaceInAnOrderThatSharesThem) {
  const geometry::Mesh mesh = geometry::icosphere(0.05, 20);
  const Shape shape = make_shape(mesh);
  EXPECT_EQ(shape.vertices.size(), mesh.positions.size());
  ASSERT_EQ(shape.corners.size(), 3 * mesh.triangles.size());
  std::deque<std::uint32_t> shaded;  // the last 24
  std::size_t runs = 0;
  for (const std::uint32_t corner : shape.corners) {
    if (std::ranges::find(shaded, corner) != shaded.end()) continue;
    ++runs;
    shaded.push_back(corner);
    if (shaded.size() > 24) shaded.pop_front();
  }
  EXPECT_LT(static_cast<double>(runs), 0.75 * static_cast<double>(mesh.triangles.size()));
}

TEST(Shape, OpenEdgesAreCreasesAndEmptyTrianglesAreLeftOut) {
  geometry::Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {2, 0, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 1, 3}};
  const Shape shape = make_shape(mesh);
  EXPECT_EQ(shape.vertices.size(), 3u);
  EXPECT_EQ(creases(shape), 3u);
  EXPECT_TRUE(make_shape({}).vertices.empty());
}

}  // namespace
}  // namespace palpa::viewer
