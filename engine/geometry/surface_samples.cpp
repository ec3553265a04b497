#include "geometry/surface_samples.hpp"

#include <algorithm>
#include <glm/geometric.hpp>

namespace palpa::geometry {

CellSamples::CellSamples(const Vec3& low, double side) {
  std::size_t i = 0;
  const auto add = [&](double px, double py, double pz) {
    x[i] = static_cast<float>(low.x + px * side);
    y[i] = static_cast<float>(low.y + py * side);
    z[i] = static_cast<float>(low.z + pz * side);
    ++i;
  };
  for (int c = 0; c < 27; ++c)
    add(0.5 * (c % 3), 0.5 * (c / 3 % 3), 0.5 * (c / 9));
  for (int c = 0; c < 8; ++c)
    add(0.25 + 0.5 * (c & 1), 0.25 + 0.5 * (c >> 1 & 1), 0.25 + 0.5 * (c >> 2));
  add(0.5, 0.5, 0.5);
}

void distances2(const shader::SurfaceTriangle& t, const CellSamples& s, float* out) {
  const shader::Float3 normal{t.normal.x, t.normal.y, t.normal.z}, along{t.along.x, t.along.y, t.along.z};
  const shader::Float3 across = shader::cross3(normal, along);
  const float side0 = t.corner.w, side1 = t.rest.x, side2 = t.rest.w;
  const float d1x = t.normal.w, d1y = t.along.w, d2x = t.rest.y, d2y = t.rest.z;
  for (std::size_t i = 0; i < CellSamples::count; ++i) {
    const float rx = s.x[i] - t.corner.x, ry = s.y[i] - t.corner.y, rz = s.z[i] - t.corner.z;
    const float u = along.x * rx + along.y * ry + along.z * rz;
    const float v = across.x * rx + across.y * ry + across.z * rz;
    const float w = normal.x * rx + normal.y * ry + normal.z * rz;
    const float out0 = -v;
    const float from = u - side0;
    const float out1 = from * d1y - v * d1x, along1 = from * d1x + v * d1y;
    const float out2 = u * d2y - v * d2x, along2 = (u * d2x + v * d2y) + side2;
    const float beyond0 = u - side0, beyond1 = along1 - side1, beyond2 = along2 - side2;
    const float past0 = u < 0.0F ? u : (u > side0 ? beyond0 : 0.0F);
    const float past1 = along1 < 0.0F ? along1 : (along1 > side1 ? beyond1 : 0.0F);
    const float past2 = along2 < 0.0F ? along2 : (along2 > side2 ? beyond2 : 0.0F);
    const float flat0 = out0 * out0 + past0 * past0;
    const float flat1 = out1 * out1 + past1 * past1;
    const float flat2 = out2 * out2 + past2 * past2;
    float flat = flat1 < flat0 ? flat1 : flat0;
    flat = flat2 < flat ? flat2 : flat;
    const float most = out0 < out1 ? (out1 < out2 ? out2 : out1) : (out0 < out2 ? out2 : out0);
    flat = most < 0.0F ? 0.0F : flat;
    out[i] = w * w + flat;
  }
}

Vec3 nearest_point(const shader::SurfaceTriangle& t, const Vec3& p) {
  const Vec3 corner(t.corner.x, t.corner.y, t.corner.z), x(t.along.x, t.along.y, t.along.z);
  const Vec3 y = glm::cross(Vec3(t.normal.x, t.normal.y, t.normal.z), x);
  const Vec3 r = p - corner;
  const Vec2 at(glm::dot(r, x), glm::dot(r, y));
  const Vec2 a(0), b(t.corner.w, 0), c = -static_cast<double>(t.rest.w) * Vec2(t.rest.y, t.rest.z);
  Vec2 best = at;
  double least = -1;
  bool inside = true;
  for (const auto& [from, to] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) {
    const Vec2 side = to - from, q = at - from;
    inside = inside && q.x * side.y - q.y * side.x < 0;
    const double length2 = glm::dot(side, side);
    const Vec2 near = from + side * (length2 > 0 ? std::clamp(glm::dot(q, side) / length2, 0.0, 1.0) : 0.0);
    const double distance2 = glm::dot(at - near, at - near);
    if (least < 0 || distance2 < least) {
      least = distance2;
      best = near;
    }
  }
  if (inside) best = at;
  return corner + x * best.x + y * best.y;
}

}  // namespace palpa::geometry
