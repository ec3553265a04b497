#include "geometry/surface/surface_samples.hpp"

#include <algorithm>
#include <glm/geometric.hpp>

#include "base/lanes.hpp"

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

template <class L>
[[gnu::always_inline]] inline typename L::Float past_side(const typename L::Float& along, float side) {
  const typename L::Float beyond = along - side, zero{};
  return along < 0.0F ? along : (along > side ? beyond : zero);
}

/// Computes points from `i` on, as many as fill vectors of this width, and returns the first remaining point. The
/// vectors are written out because compilers do not turn comparisons of floats that might trap into masks.
template <class L>
[[gnu::always_inline]] inline std::size_t distances2_of(const shader::SurfaceTriangle& t, const float* x,
                                                        const float* y, const float* z, std::size_t i,
                                                        std::size_t count, float* out) {
  using Floats = typename L::Float;
  constexpr std::size_t width = L::width;
  const shader::Float3 normal{t.normal.x, t.normal.y, t.normal.z}, along{t.along.x, t.along.y, t.along.z};
  const shader::Float3 across = shader::cross3(normal, along);
  const float side0 = t.corner.w, side1 = t.rest.x, side2 = t.rest.w;
  const float d1x = t.normal.w, d1y = t.along.w, d2x = t.rest.y, d2y = t.rest.z;
  for (; i + width <= count; i += width) {
    const Floats rx = load_lanes<L>(x + i) - t.corner.x, ry = load_lanes<L>(y + i) - t.corner.y,
                 rz = load_lanes<L>(z + i) - t.corner.z;
    const Floats u = along.x * rx + along.y * ry + along.z * rz;
    const Floats v = across.x * rx + across.y * ry + across.z * rz;
    const Floats w = normal.x * rx + normal.y * ry + normal.z * rz;
    const Floats out0 = -v;
    const Floats from = u - side0;
    const Floats out1 = from * d1y - v * d1x, along1 = from * d1x + v * d1y;
    const Floats out2 = u * d2y - v * d2x, along2 = (u * d2x + v * d2y) + side2;
    const Floats past0 = past_side<L>(u, side0), past1 = past_side<L>(along1, side1),
                 past2 = past_side<L>(along2, side2);
    const Floats flat0 = out0 * out0 + past0 * past0;
    const Floats flat1 = out1 * out1 + past1 * past1;
    const Floats flat2 = out2 * out2 + past2 * past2;
    Floats flat = flat1 < flat0 ? flat1 : flat0;
    flat = flat2 < flat ? flat2 : flat;
    const Floats zero{};
    const auto inside = (out0 < 0.0F) & (out1 < 0.0F) & (out2 < 0.0F);
    flat = inside ? zero : flat;
    store_lanes<L>(w * w + flat, out + i);
  }
  return i;
}

}  // namespace

void distances2(const shader::SurfaceTriangle& t, const float* x, const float* y, const float* z, std::size_t count,
                float* out) {
  in_lanes([&]<class L>(L) PALPA_INLINED {
    const std::size_t rest = distances2_of<L>(t, x, y, z, 0, count, out);
    if constexpr (L::width > Lanes4::width) distances2_of<Lanes4>(t, x, y, z, rest, count, out);
  });
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
