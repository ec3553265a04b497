#include "sensing/target.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <numbers>

#include "base/error.hpp"

namespace palpa::sensing {
namespace {

using Size = TargetSize;

constexpr int round_sides = 16;      // of a hole; a multiple of 4
constexpr double hole_room = 0.003;  // half the side of the square cell around a hole

/// Triangles of convex polygons given counter-clockwise; geometry::weld joins their corners afterwards.
struct Builder {
  geometry::Mesh mesh;

  void polygon(const std::vector<Vec3>& corners, std::size_t apex = 0) {
    const std::size_t n = corners.size();
    for (std::size_t i = 1; i + 1 < n; ++i)
      triangle(corners[apex], corners[(apex + i) % n], corners[(apex + i + 1) % n]);
  }
  void triangle(const Vec3& a, const Vec3& b, const Vec3& c) {
    const auto first = static_cast<std::uint32_t>(mesh.positions.size());
    for (const Vec3& p : {a, b, c})
      mesh.positions.push_back(p);
    mesh.triangles.emplace_back(first, first + 1, first + 2);
  }
  /// A horizontal polygon, counter-clockwise as seen from above if `up`, else from below.
  void level(std::vector<Vec2> corners, double z, bool up) {
    if (!up) std::reverse(corners.begin(), corners.end());
    std::vector<Vec3> at;
    at.reserve(corners.size());
    for (const Vec2& p : corners)
      at.emplace_back(p, z);
    polygon(at);
  }
  /// The wall below the edge from a to b of a polygon that is counter-clockwise from above.
  void wall(const Vec2& a, const Vec2& b) {
    polygon({Vec3(a, 0), Vec3(b, 0), Vec3(b, Size::plate_thickness), Vec3(a, Size::plate_thickness)});
  }
};

/// A cell with a round hole in its middle, and the hole's wall.
void add_hole(Builder& out, const std::array<Vec2, 4>& corners) {
  const Vec2 middle = 0.5 * (corners[0] + corners[2]);
  const auto round = [&](int i) {
    const double angle = (1 + 2.0 * (i % round_sides) / round_sides) * std::numbers::pi;
    return middle + Size::hole_radius * Vec2(std::cos(angle), std::sin(angle));
  };
  constexpr int quarter = round_sides / 4;
  for (const bool up : {true, false}) {
    const double z = up ? Size::plate_thickness : 0;
    for (int side = 0; side < 4; ++side) {
      const Vec2 &from = corners[static_cast<std::size_t>(side)],
                 &to = corners[static_cast<std::size_t>((side + 1) % 4)];
      // A fan about the side's first corner over its quarter of the circle, then the triangle to the next corner.
      for (int i = side * quarter; i < (side + 1) * quarter; ++i)
        out.level({from, round(i + 1), round(i)}, z, up);
      out.level({from, to, round((side + 1) * quarter)}, z, up);
    }
  }
  for (int i = 0; i < round_sides; ++i)
    out.wall(round(i + 1), round(i));
}

/// Grid lines that divide the plate so that holes and stump have their own cells.
std::vector<double> grid(double hole_m) {
  std::vector<double> lines{-Size::plate_half, -Size::base_half, Size::base_half, Size::plate_half};
  if (hole_m > 0) {
    for (const double side : {-1.0, 1.0})
      lines.insert(lines.end(), {side * hole_m - hole_room, side * hole_m + hole_room});
  }
  std::sort(lines.begin(), lines.end());
  return lines;
}

void add_stump(Builder& out, const std::vector<double>& xs, const std::vector<double>& ys) {
  const double b = Size::base_half, bottom = Size::plate_thickness, top = bottom + Size::height;
  const auto& lean = Size::lean;
  const Vec2 low(-b + lean[2], -b + lean[3]), high(b - lean[0], b - lean[1]);
  const std::array<Vec3, 4> roof{Vec3(low.x, low.y, top), Vec3(high.x, low.y, top), Vec3(high, top),
                                 Vec3(low.x, high.y, top)};
  out.polygon({roof.begin(), roof.end()});
  /// A slope from the corners of the plate's grid along its foot up to the roof's edge.
  const auto slope = [&](const std::vector<double>& lines, const auto& foot, const Vec3& first, const Vec3& second) {
    std::vector<Vec3> corners{first};
    for (const double line : lines) {
      if (line >= -b && line <= b) corners.push_back(foot(line));
    }
    std::sort(corners.begin() + 1, corners.end(),
              [&](const Vec3& p, const Vec3& q) { return glm::dot(p - q, second - first) < 0; });
    corners.push_back(second);
    out.polygon(corners);
  };
  slope(
      ys, [&](double y) { return Vec3(b, y, bottom); }, roof[1], roof[2]);
  slope(
      xs, [&](double x) { return Vec3(x, b, bottom); }, roof[2], roof[3]);
  slope(
      ys, [&](double y) { return Vec3(-b, y, bottom); }, roof[3], roof[0]);
  slope(
      xs, [&](double x) { return Vec3(x, -b, bottom); }, roof[0], roof[1]);
}

}  // namespace

geometry::Mesh make_target(const TargetHoles& holes) {
  const bool bored = holes.x_m != 0 || holes.y_m != 0;
  const auto fits = [](double at) { return at >= Size::hole_least && at <= Size::hole_most; };
  if (bored && !(fits(holes.x_m) && fits(holes.y_m))) throw bad_usage("a target's holes must lie beside its stump");
  const std::vector<double> xs = grid(holes.x_m), ys = grid(holes.y_m);
  Builder out;
  add_stump(out, xs, ys);
  for (std::size_t i = 0; i + 1 < xs.size(); ++i) {
    for (std::size_t j = 0; j + 1 < ys.size(); ++j) {
      const std::array<Vec2, 4> corners{Vec2(xs[i], ys[j]), Vec2(xs[i + 1], ys[j]), Vec2(xs[i + 1], ys[j + 1]),
                                        Vec2(xs[i], ys[j + 1])};
      const Vec2 middle = 0.5 * (corners[0] + corners[2]);
      const bool last_x = i + 2 == xs.size(), last_y = j + 2 == ys.size();
      const bool beneath = std::max(std::abs(middle.x), std::abs(middle.y)) < Size::base_half;
      if (bored && glm::length(glm::abs(middle) - Vec2(holes.x_m, holes.y_m)) < 1e-9) {
        add_hole(out, corners);
        continue;
      }
      std::vector<Vec2> cell(corners.begin(), corners.end());
      if (last_x && last_y) {
        cell.erase(cell.begin() + 2);
        out.wall(corners[1], corners[3]);
      } else {
        if (last_x) out.wall(corners[1], corners[2]);
        if (last_y) out.wall(corners[2], corners[3]);
      }
      if (i == 0) out.wall(corners[3], corners[0]);
      if (j == 0) out.wall(corners[0], corners[1]);
      if (!beneath) out.level(cell, Size::plate_thickness, true);
      out.level(cell, 0, false);
    }
  }
  return geometry::weld(out.mesh, 1e-7);
}

std::vector<geometry::Plane> target_faces() {
  std::vector<geometry::Plane> faces{{{0, 0, 1}, Size::plate_thickness}};
  constexpr std::array<Vec2, 4> ways{Vec2(1, 0), Vec2(0, 1), Vec2(-1, 0), Vec2(0, -1)};
  for (std::size_t i = 0; i < ways.size(); ++i) {
    const Vec3 normal = glm::normalize(Vec3(ways[i] * Size::height, Size::lean[i]));
    faces.push_back({normal, glm::dot(normal, Vec3(ways[i] * Size::base_half, Size::plate_thickness))});
  }
  return faces;
}

}  // namespace palpa::sensing
