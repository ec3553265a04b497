#include "viewer/hands/gizmo.hpp"

#include <algorithm>
#include <cmath>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <numbers>

#include "viewer/picture/palette.hpp"

namespace palpa::viewer {
namespace {

constexpr double arrow_points = 78;                    ///< length of the arrows in a picture
constexpr double reach_points = 7;                     ///< how near to a handle the pointer must be
constexpr double ring = 0.72;                          ///< radius, as a share of an arrow's length
constexpr double plane_low = 0.26, plane_high = 0.46;  ///< of a square, as a share of an arrow's length
constexpr double arrow_begins = 0.14;                  ///< keeps the middle visible
constexpr double head = 0.13;
constexpr double step_m = 1e-3, step_angle = std::numbers::pi / 36;

enum class Kind { along, in, around };
Kind kind_of(Handle handle) {
  return static_cast<Kind>(static_cast<int>(handle) / 3);
}

/// The handle's axis, and the two that follow it.
std::array<Vec3, 3> axes_of(Handle handle) {
  std::array<Vec3, 3> axes{};
  for (int i = 0; i < 3; ++i)
    axes[static_cast<std::size_t>(i)][(static_cast<int>(handle) + i) % 3] = 1;
  return axes;
}

/// The handle's outline in the world. The last point of a ring or a square is its first.
std::vector<Vec3> outline(const Gizmo& gizmo, Handle handle) {
  const auto [axis, second, third] = axes_of(handle);
  const auto at = [&, u = axis, v = second, w = third](double a, double b, double c) {
    return gizmo.at + gizmo.size_m * (a * u + b * v + c * w);
  };
  switch (kind_of(handle)) {
    case Kind::along:
      return {at(arrow_begins, 0, 0), at(1, 0, 0)};
    case Kind::in:
      return {at(0, plane_low, plane_low), at(0, plane_high, plane_low), at(0, plane_high, plane_high),
              at(0, plane_low, plane_high), at(0, plane_low, plane_low)};
    case Kind::around:
      break;
  }
  std::vector<Vec3> points;
  constexpr int pieces = 64;
  for (int i = 0; i <= pieces; ++i) {
    const double turn = 2 * std::numbers::pi * i / pieces;
    points.push_back(at(0, ring * std::cos(turn), ring * std::sin(turn)));
  }
  return points;
}

/// The points in pixels, without those behind the eye.
std::vector<Vec2> flat(const std::vector<Vec3>& points, const Sight& sight) {
  const shader::ViewPush push = projection(sight.viewpoint, sight.width, sight.height);
  std::vector<Vec2> out;
  for (const Vec3& point : points) {
    const Projected p = project(push, point);
    if (!p.visible) return {};
    out.emplace_back(p.x, p.y);
  }
  return out;
}

double distance_to(const Vec2& p, const Vec2& a, const Vec2& b) {
  const Vec2 ab = b - a;
  const double length2 = glm::dot(ab, ab);
  const double along = length2 > 0 ? std::clamp(glm::dot(p - a, ab) / length2, 0.0, 1.0) : 0;
  return glm::distance(p, a + along * ab);
}

bool inside(const Vec2& p, const std::vector<Vec2>& convex) {
  int left = 0, right = 0;
  for (std::size_t i = 0; i + 1 < convex.size(); ++i) {
    const Vec2 edge = convex[i + 1] - convex[i], to = p - convex[i];
    (edge.x * to.y - edge.y * to.x > 0 ? left : right) += 1;
  }
  return left == 0 || right == 0;
}

/// How far along the line through `at` the point nearest to the ray is.
std::optional<double> along_line(const Ray& ray, const Vec3& at, const Vec3& axis) {
  const double both = glm::dot(ray.direction, axis), across = 1 - both * both;
  if (across < 2.5e-3) return std::nullopt;
  const Vec3 to = at - ray.from;
  return (both * glm::dot(to, ray.direction) - glm::dot(to, axis)) / across;
}

double in_steps(double value, double step, bool snap) {
  return snap ? std::round(value / step) * step : value;
}

}  // namespace

Gizmo gizmo_at(const Vec3& at, const Sight& sight) {
  const shader::ViewPush push = projection(sight.viewpoint, sight.width, sight.height);
  const Vec3 right = basis(sight.viewpoint).right;
  const Projected here = project(push, at), beside = project(push, at + 1e-3 * right);
  const double pixels_per_mm = std::hypot(beside.x - here.x, beside.y - here.y);
  return {at, here.visible && pixels_per_mm > 0 ? arrow_points * sight.ratio / pixels_per_mm * 1e-3 : 0};
}

std::optional<Handle> handle_at(const Gizmo& gizmo, const Sight& sight, double x, double y) {
  const Vec2 pointer(x, y);
  std::optional<Handle> nearest;
  double best = reach_points * sight.ratio;
  for (const Handle handle : all_handles) {
    const std::vector<Vec2> points = flat(outline(gizmo, handle), sight);
    if (points.empty() || gizmo.size_m <= 0) continue;
    if (kind_of(handle) == Kind::in && inside(pointer, points)) return handle;
    for (std::size_t i = 0; i + 1 < points.size(); ++i) {
      const double away = distance_to(pointer, points[i], points[i + 1]);
      if (away >= best) continue;
      best = away;
      nearest = handle;
    }
  }
  return nearest;
}

std::optional<Transform> dragged(const Gizmo& gizmo, Handle handle, const Sight& sight, const Vec2& from,
                                 const Vec2& to, bool snap) {
  const auto [axis, second, third] = axes_of(handle);
  const Ray before = line_of_sight(sight.viewpoint, from.x, from.y, sight.width, sight.height);
  const Ray now = line_of_sight(sight.viewpoint, to.x, to.y, sight.width, sight.height);
  if (kind_of(handle) == Kind::along) {
    const auto a = along_line(before, gizmo.at, axis), b = along_line(now, gizmo.at, axis);
    if (!a || !b) return std::nullopt;
    return glm::translate(Transform(1.0), axis * in_steps(*b - *a, step_m, snap));
  }
  const auto a = meet(before, gizmo.at, axis), b = meet(now, gizmo.at, axis);
  if (!a || !b) return std::nullopt;
  if (kind_of(handle) == Kind::in) {
    const Vec3 way = *b - *a;
    return glm::translate(Transform(1.0), second * in_steps(glm::dot(way, second), step_m, snap) +
                                              third * in_steps(glm::dot(way, third), step_m, snap));
  }
  const auto angle = [&, u = second, v = third](const Vec3& p) {
    return std::atan2(glm::dot(p - gizmo.at, v), glm::dot(p - gizmo.at, u));
  };
  const double turn = in_steps(std::remainder(angle(*b) - angle(*a), 2 * std::numbers::pi), step_angle, snap);
  return glm::translate(glm::rotate(glm::translate(Transform(1.0), gizmo.at), turn, axis), -gizmo.at);
}

std::vector<FlatMark> gizmo_marks(const Gizmo& gizmo, const Sight& sight, std::optional<Handle> hovered) {
  const std::array names{"x", "y", "z"};
  std::vector<FlatMark> marks;
  for (const Handle handle : all_handles) {
    std::vector<Vec2> points = flat(outline(gizmo, handle), sight);
    if (points.empty() || gizmo.size_m <= 0) continue;
    const bool held = hovered == handle;
    const auto index = static_cast<std::size_t>(handle) % 3;
    const drawing::Colour colour = held ? rgb(0xf0b000) : axis_colours[index];
    const double width = held ? 3.5 : 2;
    if (kind_of(handle) == Kind::in) {
      marks.push_back({points, with_alpha(colour, held ? 0.8f : 0.35f), width, true});
      marks.push_back({std::move(points), colour, width * 0.6});
      continue;
    }
    marks.push_back({points, with_alpha(colour, kind_of(handle) == Kind::around && !held ? 0.75f : 1.0f), width});
    if (kind_of(handle) == Kind::around) continue;
    const Vec2 way = points[1] - points[0], tip = points[1];
    const double length = glm::length(way), size = head * arrow_points * sight.ratio;
    if (length < size) continue;  // seen from its end
    const Vec2 along = way / length * size, across = Vec2(-along.y, along.x) * 0.45;
    marks.push_back({{tip + along, tip + across, tip - across}, colour, 1, true});
    marks.push_back({{tip + along * 2.2}, colour, 1, false, names[index]});
  }
  return marks;
}

}  // namespace palpa::viewer
