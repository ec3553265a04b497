// Frames and foci against Eigen's eigenvectors and an arctangent, in double precision.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <numbers>

#include "touch/harness.hpp"

namespace palpa::touch::test {
namespace {

/// Eq. (2)-(4) of a finger's contacts.
struct Exact {
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
  Eigen::Vector3d values;   ///< descending
  Eigen::Matrix3d vectors;  ///< columns
};

Eigen::Vector3d eigen(const glm::vec3& v) {
  return {v.x, v.y, v.z};
}

Exact principal_components(const Touch& touch, const Finger& finger) {
  Exact exact;
  const auto members = static_cast<double>(finger.contacts.size());
  for (const std::uint32_t i : finger.contacts)
    exact.centroid += eigen(touch.contacts[i].position) / members;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const std::uint32_t i : finger.contacts) {
    const Eigen::Vector3d d = eigen(touch.contacts[i].position) - exact.centroid;
    covariance += d * d.transpose() / members;
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
  exact.values = solver.eigenvalues().reverse();
  exact.vectors = solver.eigenvectors().rowwise().reverse();
  return exact;
}

void expect_axes_rules(const CrossSection& section) {
  const Eigen::Vector3d w1 = eigen(section.axes[0]), w2 = eigen(section.axes[1]), w3 = eigen(section.axes[2]);
  EXPECT_NEAR(w1.norm(), 1, 1e-6);
  EXPECT_NEAR(w3.norm(), 1, 1e-6);
  EXPECT_NEAR(w1.dot(w3), 0, 1e-6);
  EXPECT_NEAR((w3.cross(w1) - w2).norm(), 0, 1e-6);
  Eigen::Index largest = 0;
  w1.cwiseAbs().maxCoeff(&largest);
  EXPECT_GT(w1[largest], 0);
  if (std::abs(w3.y()) >= 1e-6) {
    EXPECT_GT(w3.y(), 0);
  } else {
    EXPECT_GT(std::abs(w3.z()) >= 1e-6 ? w3.z() : w3.x(), 0);
  }
  EXPECT_GE(section.eigenvalues[0], section.eigenvalues[1]);
  EXPECT_GE(section.eigenvalues[1], section.eigenvalues[2]);
  EXPECT_GE(section.eigenvalues[2], 0);
}

/// Frame against Eigen; directions only where eigenvalues lie apart, by what single precision makes of their distance.
void expect_frame(const Touch& touch, const Finger& finger) {
  const Exact exact = principal_components(touch, finger);
  const CrossSection& section = finger.section;
  EXPECT_LE((eigen(section.centroid) - exact.centroid).norm(), 2e-7 * (1 + exact.centroid.norm()));
  for (int k = 0; k < 3; ++k)
    EXPECT_NEAR(section.eigenvalues[k], exact.values[k], 2e-6 * exact.values[0]);
  expect_axes_rules(section);
  const auto expect_direction = [&](int k, double distance) {
    const double tolerance = 3e-6 * exact.values[0] / distance;
    if (tolerance > 0.1) return;
    EXPECT_GE(std::abs(eigen(section.axes[k]).dot(exact.vectors.col(k))), 1 - tolerance * tolerance - 1e-6);
  };
  expect_direction(0, exact.values[0] - exact.values[1]);
  expect_direction(2, exact.values[1] - exact.values[2]);
}

/// Sectors and foci from the finger's own frame, by arctangent. Contacts within 1e-5 rad of a border may go either way.
void expect_foci(const Touch& touch, const Finger& finger, std::uint32_t foci) {
  ASSERT_EQ(finger.foci.size(), foci);
  const CrossSection& s = finger.section;
  std::vector<Eigen::Vector3d> sums(foci, Eigen::Vector3d::Zero());
  std::vector<std::uint32_t> counts(foci, 0), doubtful(foci, 0);
  const Exact exact = principal_components(touch, finger);
  for (const std::uint32_t i : finger.contacts) {
    const Eigen::Vector3d x = eigen(touch.contacts[i].position), d = x - exact.centroid;
    const double x1 = eigen(s.axes[0]).dot(d) / std::sqrt(s.eigenvalues[0]);
    const double x2 = eigen(s.axes[1]).dot(d) / std::sqrt(s.eigenvalues[1]);
    // Seen from the tip of w3, w1 to w2 is counter-clockwise; angles run clockwise.
    double turns = -std::atan2(x2, x1) / (2 * std::numbers::pi);
    turns -= std::floor(turns);
    const double place = turns * foci;
    const auto sector = std::min(static_cast<std::uint32_t>(place), foci - 1);
    const double off_border = std::abs(place - std::round(place)) / foci * 2 * std::numbers::pi;
    if (off_border * std::hypot(x1, x2) < 1e-5 * (1 + std::hypot(x1, x2)) && foci > 1) {
      const auto border = static_cast<std::uint32_t>(std::round(place)) % foci;
      ++doubtful[border];
      ++doubtful[(border + foci - 1) % foci];
    }
    sums[sector] += x;
    ++counts[sector];
  }
  std::uint32_t members = 0;
  for (std::uint32_t n = 0; n < foci; ++n) {
    members += finger.foci[n].points;
    if (doubtful[n]) continue;
    ASSERT_EQ(finger.foci[n].points, counts[n]) << "sector " << n << " of " << foci;
    if (counts[n] == 0) continue;
    EXPECT_LE((eigen(finger.foci[n].position) - sums[n] / counts[n]).norm(), 1e-6) << "sector " << n << " of " << foci;
  }
  EXPECT_EQ(members, finger.contacts.size());
}

class Sections : public ::testing::Test {
 protected:
  /// One finger of all the points.
  Touch run(const std::vector<glm::vec3>& points, std::uint32_t foci = 10) {
    FingerOptions parameters = everything_is_contact(1.0);
    parameters.foci = foci;
    Touch touch = touch_on(Backend::cpu, points, {everything()}, parameters);
    EXPECT_EQ(touch.finger_count, points.empty() ? 0u : 1u);
    return touch;
  }
};

/// A flat ellipsoid of points, turned and put anywhere.
std::vector<glm::vec3> blob(std::uint32_t count, const Vec3& axes, const Vec3& centre, double angle, unsigned seed) {
  std::vector<glm::vec3> points;
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(angle, Eigen::Vector3d(0.48, 0.6, -0.64).normalized()).toRotationMatrix();
  for (const glm::vec3& p : random_points(count, -axes, axes, seed)) {
    const Eigen::Vector3d q = turn * eigen(p);
    points.emplace_back(centre.x + q.x(), centre.y + q.y(), centre.z + q.z());
  }
  return points;
}

TEST_F(Sections, AgreeWithDoublePrecision) {
  unsigned seed = 0;
  for (const std::uint32_t count : {3U, 4U, 5U, 17U, 127U, 128U, 129U, 350U, 5000U, 60'000U}) {
    for (const Vec3& axes : {Vec3(5e-3, 3e-3, 0.5e-3), Vec3(20e-3, 1e-3, 0.9e-3), Vec3(4e-3, 4e-3, 4e-3)}) {
      SCOPED_TRACE(count);
      const Touch touch = run(blob(count, axes, {0.3, -0.1, 0.7}, 0.3 + seed, seed + 1));
      ++seed;
      expect_frame(touch, touch.fingers[0]);
      ASSERT_FALSE(touch.fingers[0].point_like);
      expect_foci(touch, touch.fingers[0], 10);
    }
  }
}

TEST_F(Sections, HaveAnyNumberOfFoci) {
  const auto points = blob(2000, {6e-3, 4e-3, 1e-3}, {0, -0.1, 0}, 1.1, 5);
  for (std::uint32_t foci = 1; foci <= max_foci; ++foci)
    expect_foci(run(points, foci), run(points, foci).fingers[0], foci);
}

TEST_F(Sections, RunClockwiseSeenFromTheTipOfW3) {
  // w1 = x, w3 = y, so w2 = w3 x w1 = -z. From above (+y) with x to the right, +z is nearer the viewer's feet:
  // clockwise from x comes +z.
  std::vector<glm::vec3> points;
  for (int k = 0; k < 4; ++k) {
    const double angle = std::numbers::pi / 4 + k * std::numbers::pi / 2;
    for (const double wide : {0.9, 1.0, 1.1})
      points.emplace_back(0.02 * wide * std::cos(angle), 0.1, 0.01 * wide * std::sin(angle));
  }
  const Touch touch = run(points, 4);
  const Finger& finger = touch.fingers[0];
  EXPECT_NEAR(finger.section.axes[0].x, 1, 1e-6);
  EXPECT_NEAR(finger.section.axes[1].z, -1, 1e-6);
  EXPECT_NEAR(finger.section.axes[2].y, 1, 1e-6);
  const double x = 0.02 * std::sqrt(0.5), z = 0.01 * std::sqrt(0.5);
  const std::vector<Vec3> expected{{x, 0.1, z}, {-x, 0.1, z}, {-x, 0.1, -z}, {x, 0.1, -z}};
  for (int n = 0; n < 4; ++n) {
    EXPECT_EQ(finger.foci[n].points, 3u);
    EXPECT_LE(glm::length(Vec3(finger.foci[n].position) - expected[n]), 1e-7) << n;
  }
}

TEST_F(Sections, BordersBelongToTheSectorThatBeginsThere) {
  // Symmetric, with coordinates that single precision holds exactly: contacts on all four half-axes and on the
  // centroid.
  std::vector<glm::vec3> points{{0.25, 0, 0}, {0, 0, 0.125}, {-0.25, 0, 0}, {0, 0, -0.125}, {0, 0, 0}};
  for (std::uint32_t foci = 4; foci <= max_foci; foci += 4) {
    const Touch touch = run(points, foci);
    const Finger& finger = touch.fingers[0];
    ASSERT_FALSE(finger.point_like);
    EXPECT_EQ(finger.section.axes[0], glm::vec3(1, 0, 0));
    EXPECT_EQ(finger.section.axes[2], glm::vec3(0, 1, 0));
    // The centroid's contact is in the first sector; the others each begin a quarter of the sectors.
    EXPECT_EQ(finger.foci[0].points, 2u);
    EXPECT_EQ(finger.foci[0].position, glm::vec3(0.125, 0, 0));
    EXPECT_EQ(finger.foci[foci / 4].position, glm::vec3(0, 0, 0.125));
    EXPECT_EQ(finger.foci[foci / 2].position, glm::vec3(-0.25, 0, 0));
    EXPECT_EQ(finger.foci[3 * foci / 4].position, glm::vec3(0, 0, -0.125));
  }
}

void expect_point_like(const Touch& touch, const Vec3& centroid) {
  const Finger& finger = touch.fingers[0];
  EXPECT_TRUE(finger.point_like);
  ASSERT_EQ(finger.foci.size(), 1u);
  EXPECT_EQ(finger.foci[0].points, finger.contacts.size());
  EXPECT_LE(glm::length(Vec3(finger.foci[0].position) - centroid), 1e-7);
  EXPECT_LE(glm::length(Vec3(finger.section.centroid) - centroid), 1e-7);
  for (const float value : finger.section.eigenvalues)
    EXPECT_TRUE(std::isfinite(value));
  expect_axes_rules(finger.section);
}

TEST_F(Sections, OfOneOrTwoContactsArePointLike) {
  expect_point_like(run({{0.1, 0.2, 0.3}}), {0.1, 0.2, 0.3});
  const Touch two = run({{0.1, 0.2, 0.3}, {0.12, 0.2, 0.3}});
  expect_point_like(two, {0.11, 0.2, 0.3});
  EXPECT_NEAR(two.fingers[0].section.axes[0].x, 1, 1e-6);
  EXPECT_NEAR(two.fingers[0].section.eigenvalues[0], 1e-4, 1e-9);
  expect_point_like(run({{0.1, 0.2, 0.3}, {0.1, 0.2, 0.3}}), {0.1, 0.2, 0.3});
}

TEST_F(Sections, OfCollinearContactsArePointLike) {
  const std::vector<Vec3> directions{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 2, 3}, {-0.3, 0.01, 5}, {1, 1, 0}};
  for (const Vec3& direction : directions) {
    for (const int count : {3, 10, 500}) {
      std::vector<glm::vec3> points;
      Vec3 centroid(0);
      for (int i = 0; i < count; ++i) {
        points.emplace_back(Vec3(0.05, -0.02, 0.03) + glm::normalize(direction) * (0.02 * i / count));
        centroid += Vec3(points.back()) / static_cast<double>(count);
      }
      expect_point_like(run(points), centroid);
    }
  }
}

TEST_F(Sections, OfCoincidentContactsArePointLike) {
  expect_point_like(run(std::vector<glm::vec3>(100, {0.3F, -0.2F, 0.1F})), Vec3(glm::vec3(0.3F, -0.2F, 0.1F)));
}

TEST_F(Sections, OfCoplanarContactsPointUpwardsThenTowardsZThenX) {
  for (const int thin : {1, 2, 0}) {
    Vec3 low(-5e-3, -3e-3, -4e-3), high = -low;
    low[thin] = high[thin] = 0.02;
    const Touch touch = run(random_points(300, low, high));
    EXPECT_FALSE(touch.fingers[0].point_like);
    EXPECT_NEAR(touch.fingers[0].section.axes[2][thin], 1, 1e-6);
    EXPECT_NEAR(touch.fingers[0].section.eigenvalues[2], 0, 1e-14);
    expect_foci(touch, touch.fingers[0], 10);
  }
}

}  // namespace
}  // namespace palpa::touch::test
