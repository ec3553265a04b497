#include "setup/tasks/rigid_fit.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/matrix.hpp>

namespace palpa::setup {
namespace {

/// The turn that takes the vectors `from` to `to` with the least squares: the quaternion that is the eigenvector of the
/// largest eigenvalue of Horn's symmetric matrix. Squaring the matrix again and again leaves only that one.
glm::dquat turn_of(std::span<const Vec3> from, std::span<const Vec3> to, std::span<const double> weights) {
  glm::dmat3 s(0.0);  // s[j][i]: from's i times to's j
  for (std::size_t k = 0; k < from.size(); ++k)
    s += weights[k] * glm::outerProduct(from[k], to[k]);
  const auto at = [&](int i, int j) { return s[j][i]; };
  const double wx = at(1, 2) - at(2, 1), wy = at(2, 0) - at(0, 2), wz = at(0, 1) - at(1, 0);
  const double xy = at(0, 1) + at(1, 0), xz = at(2, 0) + at(0, 2), yz = at(1, 2) + at(2, 1);
  const double x = at(0, 0), y = at(1, 1), z = at(2, 2);
  glm::dmat4 m(Vec4(x + y + z, wx, wy, wz), Vec4(wx, x - y - z, xy, xz), Vec4(wy, xy, y - x - z, yz),
               Vec4(wz, xz, yz, z - x - y));
  double size = 0;
  for (int i = 0; i < 4; ++i)
    size += glm::length(m[i]);
  m += size * glm::dmat4(1.0);  // all eigenvalues are positive
  constexpr int squarings = 50;
  for (int i = 0; i < squarings; ++i) {
    m = m * m;
    m /= m[0][0] + m[1][1] + m[2][2] + m[3][3];
  }
  int longest = 0;
  for (int i = 1; i < 4; ++i)
    longest = glm::length(m[i]) > glm::length(m[longest]) ? i : longest;
  const Vec4 q = glm::normalize(m[longest]);
  return {q[0], q[1], q[2], q[3]};
}

/// The fit with these weights.
RigidFit weighted(std::span<const Vec3> from, std::span<const Vec3> to, std::span<const double> weights) {
  double sum = 0;
  Vec3 middle_from(0), middle_to(0);
  for (std::size_t i = 0; i < from.size(); ++i) {
    sum += weights[i];
    middle_from += weights[i] * from[i];
    middle_to += weights[i] * to[i];
  }
  middle_from /= sum;
  middle_to /= sum;
  std::vector<Vec3> a, b;
  for (std::size_t i = 0; i < from.size(); ++i) {
    a.push_back(from[i] - middle_from);
    b.push_back(to[i] - middle_to);
  }
  const glm::dquat turn = turn_of(a, b, weights);
  RigidFit fit;
  fit.T_to_from = glm::mat4_cast(turn);
  fit.T_to_from[3] = Vec4(middle_to - turn * middle_from, 1);
  double squares = 0;
  for (std::size_t i = 0; i < from.size(); ++i) {
    fit.off_m.push_back(glm::distance(turn * a[i], b[i]));
    squares += fit.off_m.back() * fit.off_m.back();
  }
  fit.residual_m = std::sqrt(squares / static_cast<double>(from.size()));
  return fit;
}

}  // namespace

RigidFit fit_rigid(std::span<const Vec3> from, std::span<const Vec3> to) {
  return weighted(from, to, std::vector<double>(from.size(), 1));
}

RigidFit fit_rigid_robustly(std::span<const Vec3> from, std::span<const Vec3> to, double scale_m) {
  RigidFit fit = fit_rigid(from, to);
  constexpr int iterations = 20;
  for (int i = 0; i < iterations; ++i) {
    std::vector<double> weights;
    for (const double off_m : fit.off_m)
      weights.push_back(1 / (1 + off_m * off_m / (scale_m * scale_m)));
    fit = weighted(from, to, weights);
  }
  return fit;
}

double height_of(std::span<const Vec3> points) {
  double most = 0;
  for (const Vec3& a : points) {
    for (const Vec3& b : points) {
      for (const Vec3& c : points) {
        const Vec3 ab = b - a, ac = c - a;
        const double side = std::max({glm::length(ab), glm::length(ac), glm::length(ac - ab)});
        if (side > 0) most = std::max(most, glm::length(glm::cross(ab, ac)) / side);
      }
    }
  }
  return most;
}

}  // namespace palpa::setup
