// The pose of a mesh, from points measured on it.
#include "geometry/mesh/mesh_fit.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <random>
#include <vector>

#include "geometry/symmetric.hpp"
#include "support/shapes.hpp"

namespace palpa::test {
namespace {

using namespace geometry;

const Vec3 half(0.03, 0.02, 0.025);

/// Points on these sides of a box of 60 x 40 x 50 mm (0: x, 1: y, 2: z, all towards +), where a ray from (1, 1, 1)
/// meets them; each point is off by `noise_m` along its ray.
std::vector<MeasuredPoint> points_on(const std::vector<int>& sides, double noise_m) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(-1, 1);
  const Vec3 ray = glm::normalize(Vec3(-1, -1, -1));
  std::vector<MeasuredPoint> points;
  for (const int side : sides) {
    for (int i = 0; i < 600; ++i) {
      Vec3 at(place(random), place(random), place(random));
      at[side] = 1;
      points.push_back({at * half + ray * (noise_m * place(random)), ray});
    }
  }
  return points;
}

TEST(MeshFit, BringsPointsOntoTheirFacesInSpiteOfOutliers) {
  const MeshFit fit(box(-half, half));
  std::vector<MeasuredPoint> points = points_on({0, 1, 2}, 2e-4);
  for (std::size_t i = 0; i < points.size(); i += 5)
    points[i].position += Vec3(0, 0.002, 0.0015);
  const Transform guess =
      glm::translate(glm::rotate(Transform(1.0), 0.02, Vec3(0.6, 0, 0.8)), Vec3(0.0008, -0.0006, 0.0009));
  const MeshFitted fitted = fit.fit(points, guess, {.gate_m = 4e-3, .crease_m = 1e-3, .alike = 1, .steps = 30});
  const Vec3 corner = transform_point(fitted.T_mesh_points, half);
  EXPECT_LT(glm::distance(corner, half), 6e-5);
  EXPECT_LT(fitted.deviation_m, 3e-5);
  EXPECT_GT(fitted.deviation_m, 2e-6);
  // Errors of up to 0.2 mm along a ray at 55 degrees from each normal.
  EXPECT_NEAR(fitted.rms_m, 2e-4 / 3, 1e-5);
  EXPECT_NEAR(fitted.p95_m, 0.95 * 2e-4 / std::sqrt(3.0), 1.5e-5);
  EXPECT_GT(fitted.hold, 0.1);
  EXPECT_GT(fitted.points, 1200U);
  EXPECT_LT(fitted.points, 1560U);
}

TEST(MeshFit, ReportsDirectionsThatThePointsDoNotHold) {
  const MeshFit fit(box(-half, half));
  EXPECT_LT(fit.fit(points_on({2}, 0), Transform(1.0), {}).hold, 1e-6);
  EXPECT_LT(fit.fit(points_on({0, 2}, 0), Transform(1.0), {}).hold, 1e-6);
  EXPECT_EQ(fit.fit({}, Transform(1.0), {}).points, 0U);
  // Free directions keep the values of the initial guess.
  const MeshFitted flat = fit.fit(points_on({2}, 0), glm::translate(Transform(1.0), Vec3(0.003, 0, 0.001)), {});
  EXPECT_NEAR(flat.T_mesh_points[3].x, 0.003, 1e-6);
  EXPECT_NEAR(flat.T_mesh_points[3].z, 0, 1e-9);
  // Faces that look away have no points.
  std::vector<MeasuredPoint> behind = points_on({2}, 0);
  for (MeasuredPoint& point : behind)
    point.error = -point.error;
  EXPECT_EQ(fit.fit(behind, Transform(1.0), {}).points, 0U);
}

TEST(Symmetric, EigenvaluesAndVectorsAreFound) {
  // Q diag(values) Q^T with a rotation Q.
  const std::array<double, 3> values{4, -1, 1e-9};
  const Transform q = glm::rotate(Transform(1.0), 1.1, glm::normalize(Vec3(1, 2, 3)));
  Matrix<3> a{};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      for (int k = 0; k < 3; ++k)
        a[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] +=
            q[k][i] * values[static_cast<std::size_t>(k)] * q[k][j];
    }
  }
  const EigenPairs<3> found = eigen_of(a);
  for (std::size_t k = 0; k < 3; ++k) {
    const auto nearest = *std::min_element(values.begin(), values.end(), [&](double x, double y) {
      return std::abs(x - found.values[k]) < std::abs(y - found.values[k]);
    });
    EXPECT_NEAR(found.values[k], nearest, 1e-14);
    for (std::size_t i = 0; i < 3; ++i) {
      double product = 0;
      for (std::size_t j = 0; j < 3; ++j)
        product += a[i][j] * found.vectors[k][j];
      EXPECT_NEAR(product, found.values[k] * found.vectors[k][i], 1e-14);
    }
  }
}

}  // namespace
}  // namespace palpa::test
