#include "sensing/find_fingertip.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "sensing/rays.hpp"

namespace palpa::sensing {
namespace {

constexpr double farthest_m = 1, least_radius_m = 5e-3, most_radius_m = 11e-3;
/// The end of a finger: so far back from its farthest point, and so wide.
constexpr double end_depth_m = 9e-3, end_half_width_m = 14e-3;
/// The farthest points are at the end only if there are this many of them; fewer may be noise.
constexpr std::size_t outermost = 20, least_points = 60;
/// Neighbours on one surface differ by less.
constexpr double step_m = 4e-3;

/// The hand's pixels: raw depths, 0 for all else.
std::vector<std::uint16_t> hand_pixels(const Camera& camera, std::span<const std::uint16_t> depth) {
  std::vector<std::uint16_t> hand(depth.size(), 0);
  const std::uint32_t first = first_valid_depth(camera);
  const double last = farthest_m / camera.depth_unit_m;
  for (std::size_t i = 0; i < depth.size(); ++i) {
    const auto u = static_cast<std::uint32_t>(i % camera.width), v = static_cast<std::uint32_t>(i / camera.width);
    if (depth[i] >= first && depth[i] <= last && !is_ignored(camera, u, v) &&
        (!camera.background || depth[i] <= nearer_than_background(camera, i)))
      hand[i] = depth[i];
  }
  return hand;
}

/// Whether all neighbours of a pixel that is not at the image's edge, except one, are on the same surface.
bool inside_surface(const std::vector<std::uint16_t>& hand, std::size_t at, std::uint32_t width, int step) {
  int same = 0;
  for (const std::size_t row : {at - width, at, at + width}) {
    for (std::size_t pixel = row - 1; pixel <= row + 1; ++pixel)
      same += hand[pixel] != 0 && std::abs(hand[pixel] - hand[at]) < step ? 1 : 0;
  }
  return same >= 8;
}

/// One step of Gauss and Newton for the ball; false if the points do not fix it.
bool improve(std::span<const Vec3> points, Fingertip& ball) {
  constexpr double scale_m = 0.7e-3;
  glm::dmat4 a(0.0);
  Vec4 b(0);
  for (const Vec3& p : points) {
    const Vec3 away = p - ball.centre_m;
    const double distance = glm::length(away);
    if (!(distance > 0)) return false;
    const double off = distance - ball.radius_m, weight = 1 / (1 + off * off / (scale_m * scale_m));
    const Vec4 row(-away / distance, -1);
    a += weight * glm::outerProduct(row, row);
    b -= weight * off * row;
  }
  // The radius of a few points is loosely 8 mm.
  constexpr double usual_radius_m = 8e-3, pull = 20;
  a[3][3] += pull;
  b[3] += pull * (usual_radius_m - ball.radius_m);
  if (!(std::abs(glm::determinant(a)) > 0)) return false;
  const Vec4 step = glm::inverse(a) * b;
  ball.centre_m += Vec3(step);
  ball.radius_m = std::clamp(ball.radius_m + step[3], least_radius_m, most_radius_m);
  return std::isfinite(ball.centre_m.x + ball.centre_m.y + ball.centre_m.z);
}

}  // namespace

std::vector<Vec3> hand_points(const Camera& camera, const RayTables& rays, std::span<const std::uint16_t> depth) {
  const std::vector<std::uint16_t> hand = hand_pixels(camera, depth);
  const int step = std::max(1, static_cast<int>(step_m / camera.depth_unit_m));
  std::vector<Vec3> points;
  for (std::uint32_t v = 1; v + 1 < camera.height; ++v) {
    for (std::uint32_t u = 1; u + 1 < camera.width; ++u) {
      const std::size_t at = std::size_t{v} * camera.width + u;
      if (hand[at] == 0 || !inside_surface(hand, at, camera.width, step)) continue;
      const Vec2 ray(rays.rays[std::size_t{v} * rays.cameras[0].pitch + u]);
      const double z = hand[at] * camera.depth_unit_m;
      points.emplace_back(ray.x * z, ray.y * z, z);
    }
  }
  return points;
}

std::optional<Fingertip> find_fingertip(std::span<const Vec3> hand, const Vec3& way) {
  if (hand.size() < least_points) return std::nullopt;
  std::vector<Vec3> points(hand.begin(), hand.end());
  const auto farther = [&](const Vec3& a, const Vec3& b) { return glm::dot(a, way) > glm::dot(b, way); };
  std::ranges::nth_element(points, points.begin() + outermost, farther);
  Vec3 end(0);
  for (std::size_t i = 0; i < outermost; ++i)
    end += points[i] / static_cast<double>(outermost);
  const double last = glm::dot(points[outermost], way);
  std::erase_if(points, [&](const Vec3& p) {
    const Vec3 off = p - end;
    return glm::dot(p, way) < last - end_depth_m || glm::length(off - glm::dot(off, way) * way) > end_half_width_m;
  });
  if (points.size() < least_points) return std::nullopt;
  Fingertip ball{end + 8e-3 * (glm::normalize(end) - way), 8e-3, 0};  // behind the skin, as the camera sees it
  constexpr int steps = 30;
  for (int i = 0; i < steps; ++i) {
    if (!improve(points, ball)) return std::nullopt;
  }
  double sum = 0;
  for (const Vec3& p : points) {
    const double off = glm::distance(p, ball.centre_m) - ball.radius_m;
    sum += off * off;
  }
  ball.rms_m = std::sqrt(sum / static_cast<double>(points.size()));
  constexpr double most_rms_m = 2e-3;
  return ball.rms_m < most_rms_m ? std::optional(ball) : std::nullopt;
}

}  // namespace palpa::sensing
