// Meshes as they are drawn: vertices, edges, outlines, and coarser forms.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <glm/geometric.hpp>
#include <numbers>

#include "geometry/mesh/icosphere.hpp"
#include "viewer/picture/detail.hpp"
#include "viewer/picture/shape.hpp"
#include "viewer/scenes.hpp"

namespace palpa::viewer {
namespace {

Vec3 xyz(const shader::vec4& v) {
  return {v.x, v.y, v.z};
}

TEST(Shape, ACubeHasTwelveCreasesAndFlatFaces) {
  const Shape shape = make_shape(test::box({-1, -1, -1}, {1, 1, 1}));
  EXPECT_EQ(shape.vertices.size(), 24u);  // four for each face
  EXPECT_EQ(shape.corners.size(), 36u);
  EXPECT_EQ(shape.edges.creases.size(), 12u);
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
  EXPECT_EQ(shape.edges.creases.size(), 2 * n);
  EXPECT_EQ(shape.edges.folds.size(), n);  // the vertical ones, for the outline
  for (const auto& v : shape.vertices) {
    if (std::abs(v.normal.y) < 0.5) {  // on the side: radial
      EXPECT_NEAR(glm::distance(xyz(v.normal), Vec3(v.position.x, 0, v.position.z)), 0, 0.06);
    }
  }
}

// A ball with a scanner's error at one place: the fold exists, but no line must be drawn there.
TEST(Shape, ShortFoldsThatEndAreNoCreases) {
  const auto ball_with_bump = [](double height) {
    geometry::Mesh mesh = test::sphere(1, 24, 48);
    for (const std::size_t neighbour : {5, 6})
      mesh.positions[1 + 11 * 48 + neighbour] *= 1 + height;  // on the equator
    return mesh;
  };
  std::ptrdiff_t folds = 0;
  for (double height = 0; folds == 0 && height < 0.2; height += 0.002) {
    const Shape shape = make_shape(ball_with_bump(height));
    const auto normal = [&](std::uint32_t face) { return xyz(shape.edges.planes[face]); };
    folds = std::ranges::count_if(shape.edges.folds, [&](const EdgeNet::Fold& fold) {
      return glm::dot(normal(fold.left), normal(fold.right)) <= std::cos(0.52);
    });
    EXPECT_EQ(shape.edges.creases.size(), 0u);
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
  EXPECT_EQ(shape.edges.creases.size(), 3u);
  EXPECT_TRUE(make_shape({}).vertices.empty());
}

TEST(Outline, OfABallIsTheCircleWhereSightGrazesIt) {
  constexpr double radius = 0.05, away = 0.2;
  const Shape ball = make_shape(geometry::icosphere(radius, 30));
  Outliner outliner;
  std::vector<shader::ViewEdge> lines;
  outliner.find(ball.edges, {0, 0, away, 1}, lines);
  double length = 0;
  for (const shader::ViewEdge& line : lines) {
    length += glm::distance(xyz(line.from), xyz(line.to));
    EXPECT_NEAR(line.from.z, radius * radius / away, 0.06 * radius);  // where the ray is tangent
  }
  const double circle = 2 * 3.14159265 * std::sqrt(radius * radius - std::pow(radius * radius / away, 2));
  EXPECT_GT(length, circle);
  EXPECT_LT(length, 1.4 * circle);  // it follows edges, in a zigzag
  EXPECT_LT(lines.size(), ball.edges.folds.size() / 20);

  const std::size_t before = lines.size();
  outliner.find(ball.edges, {1, 0, 0, 0}, lines);  // from infinitely far away: the great circle
  ASSERT_GT(lines.size(), before);
  for (std::size_t i = before; i < lines.size(); ++i)
    EXPECT_NEAR(lines[i].from.x, 0, 0.06 * radius);
}

TEST(Detail, CoarserFormsLieWhereTheySayAndFaceOutwards) {
  const geometry::Mesh mesh = geometry::icosphere(0.05, 20);  // 8000 faces
  const Shape shape = make_shape(mesh);
  const std::vector<Detail> details = coarser(shape.vertices, shape.corners);
  ASSERT_GE(details.size(), 2u);
  std::size_t before = shape.corners.size();
  double error_before = 0;
  for (const Detail& detail : details) {
    EXPECT_LT(detail.corners.size(), before / 10 * 9);
    EXPECT_GE(detail.error_m, error_before);
    EXPECT_LT(detail.error_m, 2e-3);
    before = detail.corners.size();
    error_before = detail.error_m;
    for (std::size_t t = 0; t < detail.corners.size(); t += 3) {
      const Vec3 a = xyz(shape.vertices[detail.corners[t]].position),
                 b = xyz(shape.vertices[detail.corners[t + 1]].position),
                 c = xyz(shape.vertices[detail.corners[t + 2]].position);
      const Vec3 middle = (a + b + c) / 3.0;
      EXPECT_GT(glm::dot(glm::cross(b - a, c - a), middle), -1e-11);  // except slivers
      EXPECT_GT(glm::length(middle), 0.05 - 3e-3);
    }
  }
  const Shape box = make_shape(test::box({-1, -1, -1}, {1, 1, 1}));
  EXPECT_TRUE(coarser(box.vertices, box.corners).empty());
}

}  // namespace
}  // namespace palpa::viewer
