#include "geometry/surface/surface_samples.hpp"

#include <algorithm>
#include <cstring>
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
  for (int c = 0; c < 27; ++c) {
    const int column = c % 3, row = c / 3 % 3, layer = c / 9;
    add(0.5 * column, 0.5 * row, 0.5 * layer);
  }
  for (int c = 0; c < 8; ++c)
    add(0.25 + 0.5 * (c & 1), 0.25 + 0.5 * (c >> 1 & 1), 0.25 + 0.5 * (c >> 2));
  add(0.5, 0.5, 0.5);
}

namespace {

// Four points at a time. Compilers do not turn float comparisons into masks by themselves if these might trap.
using Four [[gnu::vector_size(16)]] = float;

Four load(const float* from) {
  Four value;
  std::memcpy(&value, from, sizeof(value));
  return value;
}

Four past_side(Four along, float side) {
  const Four beyond = along - side, zero{};
  return along < 0.0F ? along : (along > side ? beyond : zero);
}

}  // namespace

void distances2(const shader::SurfaceTriangle& t, const float* x, const float* y, const float* z, std::size_t count,
                float* out) {
  const shader::Float3 normal{t.normal.x, t.normal.y, t.normal.z}, along{t.along.x, t.along.y, t.along.z};
  const shader::Float3 across = shader::cross3(normal, along);
  const float side0 = t.corner.w, side1 = t.rest.x, side2 = t.rest.w;
  const float d1x = t.normal.w, d1y = t.along.w, d2x = t.rest.y, d2y = t.rest.z;
  for (std::size_t i = 0; i < count; i += 4) {
    const Four rx = load(x + i) - t.corner.x, ry = load(y + i) - t.corner.y, rz = load(z + i) - t.corner.z;
    const Four u = along.x * rx + along.y * ry + along.z * rz;
    const Four v = across.x * rx + across.y * ry + across.z * rz;
    const Four w = normal.x * rx + normal.y * ry + normal.z * rz;
    const Four out0 = -v;
    const Four from = u - side0;
    const Four out1 = from * d1y - v * d1x, along1 = from * d1x + v * d1y;
    const Four out2 = u * d2y - v * d2x, along2 = (u * d2x + v * d2y) + side2;
    const Four past0 = past_side(u, side0), past1 = past_side(along1, side1), past2 = past_side(along2, side2);
    const Four flat0 = out0 * out0 + past0 * past0;
    const Four flat1 = out1 * out1 + past1 * past1;
    const Four flat2 = out2 * out2 + past2 * past2;
    Four flat = flat1 < flat0 ? flat1 : flat0;
    flat = flat2 < flat ? flat2 : flat;
    const Four zero{};
    const auto inside = (out0 < 0.0F) & (out1 < 0.0F) & (out2 < 0.0F);
    flat = inside ? zero : flat;
    const Four square = w * w + flat;
    std::memcpy(out + i, &square, sizeof(square));
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
