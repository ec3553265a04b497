#include "viewer/view/frustum.hpp"

#include <algorithm>
#include <glm/geometric.hpp>

namespace palpa::viewer {
Frustum through(const sensing::Camera& camera) {
  Transform upright(1.0);  // a camera's y is down and its z forward
  upright[1][1] = upright[2][2] = -1;
  Frustum frustum;
  frustum.T_world_eye = camera.T_world_camera * upright;
  // Pixel centres are whole numbers, so the image begins half a pixel before the first.
  frustum.low = {(-0.5 - camera.cx) / camera.fx, (camera.cy + 0.5 - camera.height) / camera.fy};
  frustum.high = {(camera.width - 0.5 - camera.cx) / camera.fx, (camera.cy + 0.5) / camera.fy};
  return frustum;
}

Frustum shown(const Frustum& frustum, double aspect) {
  Frustum out = frustum;
  if (frustum.exact) return out;
  const Vec2 size = frustum.high - frustum.low;
  const Vec2 more(std::max(0.0, size.y * aspect - size.x) / 2, std::max(0.0, size.x / aspect - size.y) / 2);
  out.low -= more;
  out.high += more;
  return out;
}

shader::ViewPush projection(const Frustum& frustum, double width, double height, double nearest_m) {
  const Frustum window = shown(frustum, width / height);
  const Vec3 right(window.T_world_eye[0]), up(window.T_world_eye[1]), forward(-window.T_world_eye[2]);
  const Vec3 eye(window.T_world_eye[3]);
  const Vec2 size = window.high - window.low, middle = (window.high + window.low) / size;
  const auto axis = [&](const Vec3& direction) { return vec4_of(direction, -glm::dot(direction, eye)); };
  shader::ViewPush push{};
  push.clip_x = axis(right * (2 / size.x) - forward * middle.x);
  push.clip_y = axis(forward * middle.y - up * (2 / size.y));
  push.clip_z = {0, 0, 0, static_cast<float>(nearest_m)};
  push.clip_w = axis(forward);
  push.eye = vec4_of(eye, 1);
  push.window = {static_cast<float>(width), static_cast<float>(height), static_cast<float>(height / size.y), 0};
  return push;
}

}  // namespace palpa::viewer
