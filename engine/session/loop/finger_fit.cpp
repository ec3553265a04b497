#include "session/loop/finger_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "geometry/mesh/topology.hpp"
#include "geometry/symmetric.hpp"

namespace palpa::session {
namespace {

constexpr double lever_m = 10e-3;  // a rotation by an angle counts like a shift by that angle times this
constexpr double hold = 1e-3;      // of the mean square of a point's effect: holds what the points do not determine
constexpr double first_gate_m = 8e-3, gate_m = 4e-3;
constexpr double least_scatter_m = 0.2e-3;
constexpr double tukey = 4.685;
constexpr double still_m = 5e-6;
constexpr double end_margin_m = 3e-3;
constexpr int first_steps = 25, more_steps = 8;

/// Solves the symmetric positive-definite system in place.
std::array<double, 6> solve(std::array<std::array<double, 6>, 6> a, std::array<double, 6> b) {
  for (std::size_t k = 0; k < 6; ++k) {
    for (std::size_t i = k + 1; i < 6; ++i) {
      const double part = a[i][k] / a[k][k];
      for (std::size_t j = k; j < 6; ++j)
        a[i][j] -= part * a[k][j];
      b[i] -= part * b[k];
    }
  }
  for (std::size_t k = 6; k-- > 0;) {
    for (std::size_t j = k + 1; j < 6; ++j)
      b[k] -= a[k][j] * b[j];
    b[k] /= a[k][k];
  }
  return b;
}

/// The direction in which the points extend farthest.
Vec3 longest_axis(std::span<const Vec3> points) {
  const Vec3 mean = mean_of(points);
  geometry::Matrix<3> covariance{};
  for (const Vec3& p : points) {
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j)
        covariance[static_cast<std::size_t>(i)][static_cast<std::size_t>(j)] += (p - mean)[i] * (p - mean)[j];
    }
  }
  const geometry::EigenPairs<3> axes = geometry::eigen_of(covariance);
  const auto longest = static_cast<std::size_t>(std::ranges::max_element(axes.values) - axes.values.begin());
  return {axes.vectors[longest][0], axes.vectors[longest][1], axes.vectors[longest][2]};
}

/// Upright along `y`, with the tip where the skin ends; in the middle of the finger it is on its axis.
Transform standing(std::span<const Vec3> skin, const Vec3& y) {
  const Vec3 mean = mean_of(skin);
  const Vec3 beside = std::abs(y.x) < 0.9 ? Vec3(1, 0, 0) : Vec3(0, 0, 1);
  const Vec3 x = glm::normalize(beside - glm::dot(beside, y) * y), z = glm::cross(x, y);
  double lowest = 0;
  for (const Vec3& p : skin)
    lowest = std::min(lowest, glm::dot(p - mean, y));
  Transform pose(1.0);
  pose[0] = Vec4(x, 0);
  pose[1] = Vec4(y, 0);
  pose[2] = Vec4(z, 0);
  pose[3] = Vec4(mean + lowest * y, 1);
  return pose;
}

}  // namespace

Vec3 mean_of(std::span<const Vec3> points) {
  Vec3 mean(0);
  for (const Vec3& p : points)
    mean += p / static_cast<double>(points.size());
  return mean;
}

FingerFit::FingerFit(const geometry::Mesh& finger)
    : nearest_(finger), normals_(unit_normals(finger)), end_m_(geometry::bounds(finger).high.y - end_margin_m) {}

FittedPose FingerFit::fit(std::span<const Vec3> skin, Transform T_world_finger, int steps) const {
  struct Hit {
    Vec3 place, normal;
    double off_m;
  };
  std::vector<Hit> hits;
  std::vector<double> sizes;
  for (int step = 0; step < steps; ++step) {
    const Transform T_finger_world = glm::inverse(T_world_finger);
    const double gate = step < steps / 3 ? first_gate_m : gate_m;
    hits.clear();
    sizes.clear();
    Vec3 centre(0);
    for (const Vec3& p : skin) {
      const Vec3 place = transform_point(T_finger_world, p);
      if (place.y > end_m_) continue;
      const auto found = nearest_.find(place, gate);
      if (!found || found->point.y > end_m_) continue;
      const Vec3& normal = normals_[found->triangle];
      hits.push_back({place, normal, glm::dot(place - found->point, normal)});
      sizes.push_back(std::abs(hits.back().off_m));
      centre += place;
    }
    if (hits.size() < fewest) break;
    centre /= static_cast<double>(hits.size());
    std::ranges::nth_element(sizes, sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2));
    const double scatter = std::max(1.4826 * sizes[sizes.size() / 2], least_scatter_m);
    std::array<std::array<double, 6>, 6> normal{};
    std::array<double, 6> rest{};
    double weights = 0;
    for (const Hit& hit : hits) {
      const double part = hit.off_m / (tukey * scatter);
      if (std::abs(part) >= 1) continue;
      const double weight = (1 - part * part) * (1 - part * part);
      const Vec3 turn = glm::cross(hit.place - centre, hit.normal) / lever_m;
      const std::array<double, 6> row{hit.normal.x, hit.normal.y, hit.normal.z, turn.x, turn.y, turn.z};
      for (std::size_t i = 0; i < 6; ++i) {
        for (std::size_t j = 0; j < 6; ++j)
          normal[i][j] += weight * row[i] * row[j];
        rest[i] -= weight * row[i] * hit.off_m;
      }
      weights += weight;
    }
    for (std::size_t i = 0; i < 6; ++i)
      normal[i][i] += hold * weights + 1e-12;
    const std::array<double, 6> move = solve(normal, rest);
    const Vec3 shift(move[0], move[1], move[2]), turn = Vec3(move[3], move[4], move[5]) / lever_m;
    const double angle = glm::length(turn);
    // The skin moves onto the mesh; so the mesh moves the other way.
    Transform skin_moves = glm::translate(Transform(1.0), centre + shift);
    if (angle > 0) skin_moves = glm::rotate(skin_moves, angle, turn / angle);
    skin_moves = glm::translate(skin_moves, -centre);
    T_world_finger = T_world_finger * glm::inverse(skin_moves);
    if (step >= steps / 3 && glm::length(shift) + angle * lever_m < still_m) break;
  }
  FittedPose pose{T_world_finger};
  measure(skin, pose);
  return pose;
}

void FingerFit::measure(std::span<const Vec3> skin, FittedPose& pose) const {
  const Transform T_finger_world = glm::inverse(pose.T_world_finger);
  double squares = 0;
  for (const Vec3& p : skin) {
    const double off = nearest_.distance(transform_point(T_finger_world, p), near_m);
    if (off >= near_m) continue;
    squares += off * off;
    ++pose.points;
  }
  pose.rms_m = pose.points > 0 ? std::sqrt(squares / pose.points) : 0;
}

std::optional<FittedPose> FingerFit::find(std::span<const Vec3> skin, const Vec3& contacts,
                                          const std::optional<Transform>& before) const {
  std::vector<Vec3> used;
  for (const Vec3& p : skin) {
    if (glm::distance(p, contacts) < reach_m) used.push_back(p);
  }
  if (used.size() < fewest) return std::nullopt;
  if (used.size() > most) {
    for (std::size_t i = 0; i < most; ++i)
      used[i] = used[i * used.size() / most];
    used.resize(most);
  }
  const auto fits = [&](const FittedPose& pose) {
    return pose.points >= fewest && std::size_t{2} * pose.points >= used.size();
  };
  if (before) {
    const FittedPose pose = fit(used, *before, more_steps);
    if (fits(pose)) return pose;
  }
  // From the contacts to the middle of the skin, and along the skin.
  const Vec3 away = mean_of(used) - contacts, axis = longest_axis(used);
  std::optional<FittedPose> best;
  for (const Vec3& way : {away, glm::dot(axis, away) < 0 ? -axis : axis}) {
    if (!(glm::length(way) > 0)) continue;
    const FittedPose pose = fit(used, standing(used, glm::normalize(way)), first_steps);
    if (fits(pose) && (!best || pose.points > best->points)) best = pose;
  }
  return best;
}

}  // namespace palpa::session
