#include "viewer/view/viewpoint.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

namespace palpa::viewer {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double least_distance = 1e-3, most_distance = 100.0;

}  // namespace

void look(Viewpoint& viewpoint, StandardView view) {
  viewpoint.frustum.reset();
  viewpoint.R_world_orbit = glm::dmat3(1.0);
  switch (view) {
    case StandardView::front:
      viewpoint.azimuth = 0, viewpoint.elevation = 0;
      break;
    case StandardView::right:
      viewpoint.azimuth = pi / 2, viewpoint.elevation = 0;
      break;
    case StandardView::top:
      viewpoint.azimuth = 0, viewpoint.elevation = pi / 2;
      break;
    case StandardView::iso:
    case StandardView::camera:
      viewpoint.azimuth = 0.6, viewpoint.elevation = 0.45;
      break;
  }
}

void look(Viewpoint& viewpoint, const Frustum& frustum, const Vec3& about) {
  viewpoint.frustum = frustum;
  viewpoint.R_world_orbit = glm::dmat3(frustum.T_world_eye);
  viewpoint.azimuth = viewpoint.elevation = 0;
  viewpoint.orthographic = false;
  viewpoint.fov = 2 * std::atan((frustum.high.y - frustum.low.y) / 2);
  const Vec3 eye(frustum.T_world_eye[3]), forward(-frustum.T_world_eye[2]);
  viewpoint.distance = std::clamp(glm::dot(about - eye, forward), least_distance, most_distance);
  viewpoint.target = eye + viewpoint.distance * forward;
}

void look(Viewpoint& viewpoint, const Vec3& eye, const Vec3& target) {
  viewpoint.frustum.reset();
  viewpoint.R_world_orbit = glm::dmat3(1.0);
  const Vec3 d = eye - target;
  viewpoint.target = target;
  viewpoint.distance = std::clamp(glm::length(d), least_distance, most_distance);
  viewpoint.elevation = std::atan2(d.y, std::hypot(d.x, d.z));
  viewpoint.azimuth = d.x == 0 && d.z == 0 ? 0 : std::atan2(d.x, d.z);
}

Basis basis(const Viewpoint& viewpoint) {
  if (viewpoint.frustum) {
    const Transform& T = viewpoint.frustum->T_world_eye;
    return {Vec3(T[3]), Vec3(T[0]), Vec3(T[1]), -Vec3(T[2])};
  }
  const double ca = std::cos(viewpoint.azimuth), sa = std::sin(viewpoint.azimuth);
  const double ce = std::cos(viewpoint.elevation), se = std::sin(viewpoint.elevation);
  Basis b;
  b.forward = viewpoint.R_world_orbit * Vec3(-ce * sa, -se, -ce * ca);
  b.right = viewpoint.R_world_orbit * Vec3(ca, 0, -sa);
  b.up = viewpoint.R_world_orbit * Vec3(-se * sa, ce, -se * ca);
  b.eye = viewpoint.target - viewpoint.distance * b.forward;
  return b;
}

void fit(Viewpoint& viewpoint, const Box& box, double aspect) {
  constexpr double margin = 1.18;
  viewpoint.frustum.reset();
  viewpoint.target = box.empty() ? Vec3(0) : box.centre();
  const Basis b = basis(viewpoint);
  const double tan_y = std::tan(viewpoint.fov / 2), free = 1 - viewpoint.covered_left - viewpoint.covered_right;
  const double tan_x = tan_y * aspect * free, tan_up = tan_y * (1 - viewpoint.covered_below);
  double distance = box.empty() ? 0.05 / tan_x : 0;
  for (const Vec3& corner : box.corners()) {
    if (box.empty()) break;
    const Vec3 p = corner - viewpoint.target;
    const double nearer = viewpoint.orthographic ? 0 : -glm::dot(p, b.forward);
    distance = std::max({distance, margin * std::abs(glm::dot(p, b.right)) / tan_x + nearer,
                         margin * std::abs(glm::dot(p, b.up)) / tan_up + nearer});
  }
  if (distance < 1e-6) distance = 0.05 / tan_x;
  viewpoint.distance = std::clamp(distance, least_distance, most_distance);
}

void cover_below(Viewpoint& viewpoint, double share, bool fixed) {
  const double wider = (1 - viewpoint.covered_below) / (1 - share);
  viewpoint.covered_below = share;
  if (!fixed && !viewpoint.frustum)
    viewpoint.distance = std::clamp(viewpoint.distance * wider, least_distance, most_distance);
}

void orbit(Viewpoint& viewpoint, double dx, double dy, double height) {
  const double per_pixel = pi / std::max(height, 1.0);
  viewpoint.frustum.reset();
  viewpoint.azimuth = std::remainder(viewpoint.azimuth - dx * per_pixel, 2 * pi);
  viewpoint.elevation = std::clamp(viewpoint.elevation + dy * per_pixel, -pi / 2, pi / 2);
}

void pan(Viewpoint& viewpoint, double dx, double dy, double height) {
  viewpoint.frustum.reset();
  const Basis b = basis(viewpoint);
  viewpoint.target += (b.up * dy - b.right * dx) * metres_per_pixel(viewpoint, height);
}

void zoom(Viewpoint& viewpoint, double steps) {
  viewpoint.frustum.reset();
  viewpoint.distance = std::clamp(viewpoint.distance * std::pow(0.9, steps), least_distance, most_distance);
}

double metres_per_pixel(const Viewpoint& viewpoint, double height) {
  return 2 * viewpoint.distance * std::tan(viewpoint.fov / 2) / std::max(height, 1.0);
}

shader::ViewPush projection(const Viewpoint& viewpoint, double width, double height) {
  if (viewpoint.frustum) return projection(*viewpoint.frustum, width, height, viewpoint.distance / 100);
  const Basis b = basis(viewpoint);
  const double aspect = width / height;
  const double tan_y = std::tan(viewpoint.fov / 2);
  shader::ViewPush push{};
  const auto axis = [&](const Vec3& direction, double scale) {
    return vec4_of(direction * scale, -glm::dot(direction, b.eye) * scale);
  };
  if (viewpoint.orthographic) {
    const double half = viewpoint.distance * tan_y;
    const double range = 16 * viewpoint.distance;  // from behind the eye to well behind the target
    push.clip_x = axis(b.right, 1 / (half * aspect));
    push.clip_y = axis(b.up, -1 / half);
    push.clip_z = vec4_of(-b.forward / range, (glm::dot(b.forward, viewpoint.target)) / range + 0.5);
    push.clip_w = {0, 0, 0, 1};
    push.eye = vec4_of(-b.forward, 0);
    push.window.z = static_cast<float>(height / (2 * half));
  } else {
    push.clip_x = axis(b.right, 1 / (tan_y * aspect));
    push.clip_y = axis(b.up, -1 / tan_y);
    push.clip_z = {0, 0, 0, static_cast<float>(viewpoint.distance / 100)};
    push.clip_w = axis(b.forward, 1);
    push.eye = vec4_of(b.eye, 1);
    push.window.z = static_cast<float>(height / (2 * tan_y));
  }
  const auto shift = static_cast<float>(viewpoint.covered_left - viewpoint.covered_right);
  const auto move = [&](shader::vec4& row, float by) {
    row.x += by * push.clip_w.x;
    row.y += by * push.clip_w.y;
    row.z += by * push.clip_w.z;
    row.w += by * push.clip_w.w;
  };
  move(push.clip_x, shift);
  move(push.clip_y, -static_cast<float>(viewpoint.covered_below));
  push.window.x = static_cast<float>(width);
  push.window.y = static_cast<float>(height);
  return push;
}

Projected project(const shader::ViewPush& projection, const Vec3& p) {
  const auto dot = [&](const shader::vec4& r) { return r.x * p.x + r.y * p.y + r.z * p.z + r.w; };
  const double w = dot(projection.clip_w);
  Projected out;
  out.visible = w > 1e-6;
  if (!out.visible) return out;
  out.x = (dot(projection.clip_x) / w * 0.5 + 0.5) * projection.window.x;
  out.y = (dot(projection.clip_y) / w * 0.5 + 0.5) * projection.window.y;
  out.depth = projection.eye.w > 0.5f ? w : -dot(projection.clip_z);
  return out;
}

Ray line_of_sight(const Viewpoint& viewpoint, double x, double y, double width, double height) {
  const shader::ViewPush push = projection(viewpoint, width, height);
  const Basis b = basis(viewpoint);
  // The pixel's column and its row each define a plane.
  const auto plane = [&](const shader::vec4& clip, double at) {
    return Vec4(clip.x, clip.y, clip.z, clip.w) - at * Vec4(push.clip_w.x, push.clip_w.y, push.clip_w.z, push.clip_w.w);
  };
  const Vec4 column = plane(push.clip_x, 2 * x / width - 1), line = plane(push.clip_y, 2 * y / height - 1);
  const Vec3 across = glm::cross(Vec3(column), Vec3(line));
  const Vec3 direction = glm::normalize(glm::dot(across, b.forward) < 0 ? -across : across);
  if (push.eye.w > 0.5f) return {b.eye, direction};
  const Vec3 on = (glm::cross(Vec3(line), across) * -column.w + glm::cross(across, Vec3(column)) * -line.w) /
                  glm::dot(across, across);
  return {on + direction * (glm::dot(viewpoint.target - on, direction) - 8 * viewpoint.distance), direction};
}

std::optional<Vec3> meet(const Ray& ray, const Vec3& point, const Vec3& normal) {
  const double along = glm::dot(ray.direction, normal);
  if (std::abs(along) < 0.05 * glm::length(normal)) return std::nullopt;
  const double away = glm::dot(point - ray.from, normal) / along;
  if (away <= 0) return std::nullopt;
  return ray.from + ray.direction * away;
}

}  // namespace palpa::viewer
