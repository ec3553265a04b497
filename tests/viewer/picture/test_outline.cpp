#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>

#include "geometry/mesh/icosphere.hpp"
#include "viewer/picture/detail.hpp"
#include "viewer/picture/shape.hpp"
#include "viewer/scenes.hpp"

namespace palpa::viewer {
namespace {

Vec3 xyz(const shader::vec4& v) {
  return {v.x, v.y, v.z};
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

TEST(Outline, AFlatThingHasNone) {
  Outliner outliner;
  std::vector<shader::ViewEdge> lines;
  outliner.find(make_shape(test::box({-1, -1, -1}, {1, 1, 1})).edges, {5, 4, 3, 1}, lines);
  EXPECT_TRUE(lines.empty()) << "a box is all creases";
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
