#include "assets/generators/objects.hpp"

#include <cmath>
#include <numbers>
#include <numeric>
#include <vector>

#include "assets/generators/shape.hpp"

namespace palpa::assets {
namespace {

using geometry::Mesh;

constexpr double kHalfSide = 0.020;
constexpr double kRadius = 0.020;
// 45 degrees between opposite faces: each leans 22.5 degrees from the vertical. 1 + sqrt(2) = 1 / tan(22.5 degrees).
const double kPyramidHeight = kHalfSide * (1.0 + std::numbers::sqrt2);
// Rows of the dome between pole and rim. A triangle's deepest point is its squared circumradius / (2 R) inside the
// sphere. With rows of 1.37 mm, even a right-angled triangle stays below 30 micrometres.
constexpr int kDomeRows = 23;

/// Cuts a convex polygon, given by its corners counter-clockwise seen from outside, into triangles.
void add_polygon(Mesh& mesh, const std::vector<std::uint32_t>& corners) {
  // Zigzag from both ends, so that no corner collects all the triangles.
  std::size_t low = 0, high = corners.size() - 1;
  bool advance_low = true;
  while (high - low >= 2) {
    if (advance_low) {
      mesh.triangles.emplace_back(corners[low], corners[low + 1], corners[high]);
      ++low;
    } else {
      mesh.triangles.emplace_back(corners[low], corners[high - 1], corners[high]);
      --high;
    }
    advance_low = !advance_low;
  }
}

}  // namespace

Mesh make_cube() {
  Mesh mesh;
  const double s = kHalfSide;
  for (const double y : {-2 * s, 0.0}) {
    // Counter-clockwise seen from above.
    mesh.positions.insert(mesh.positions.end(), {{-s, y, s}, {s, y, s}, {s, y, -s}, {-s, y, -s}});
  }
  add_polygon(mesh, {3, 2, 1, 0});
  add_polygon(mesh, {4, 5, 6, 7});
  for (std::uint32_t i = 0; i < 4; ++i)
    add_polygon(mesh, {i, (i + 1) % 4, (i + 1) % 4 + 4, i + 4});
  round_to_float(mesh);
  return mesh;
}

Mesh make_semi_sphere() {
  Mesh mesh;
  mesh.positions.emplace_back(0.0, 0.0, 0.0);
  Ring above{0, 1};
  double turn = 0.0;  // of a ring, in steps between its vertices
  for (int row = 1; row <= kDomeRows; ++row) {
    const double polar = row * std::numbers::pi / (2 * kDomeRows);
    const bool is_rim = row == kDomeRows;
    const double radius = is_rim ? kRadius : kRadius * std::sin(polar);
    const double y = is_rim ? -kRadius : kRadius * (std::cos(polar) - 1.0);
    // The distance between neighbours on a ring is about that of equilateral triangles with these rows. Counts are
    // multiples of six: the edges of two rings then line up either often and exactly or, as below, nowhere nearly.
    const double spacing = kRadius * std::numbers::pi / (2 * kDomeRows) * 2.0 / std::numbers::sqrt3;
    const auto count = 6 * static_cast<std::uint32_t>(std::lround(2 * std::numbers::pi * radius / spacing / 6));
    // Two parallel edges of neighbouring rings would span a flat trapezoid. The middles of edges on the two rings
    // differ by multiples of gcd / (n m) turns, plus the turn of the second ring. A turn by half of that multiple keeps
    // them farthest apart.
    if (row > 1)
      turn = count * ((0.5 + turn) / above.count - 0.5 * std::gcd(above.count, count) / above.count / count) - 0.5;
    const Ring ring{static_cast<std::uint32_t>(mesh.positions.size()), count};
    for (std::uint32_t i = 0; i < count; ++i) {
      const double angle = 2 * std::numbers::pi * (i + turn) / count;
      mesh.positions.emplace_back(radius * std::cos(angle), y, -radius * std::sin(angle));
    }
    sew(mesh, above, ring);  // on a sphere the shorter diagonal is the convex one
    above = ring;
  }
  round_to_float(mesh);
  std::vector<std::uint32_t> rim;
  for (std::uint32_t i = above.count; i-- > 0;)
    rim.push_back(above.first + i);
  add_polygon(mesh, rim);
  return mesh;
}

Mesh make_pyramid() {
  Mesh mesh;
  const double s = kHalfSide, y = -kPyramidHeight;
  mesh.positions = {{-s, y, s}, {s, y, s}, {s, y, -s}, {-s, y, -s}, {0, 0, 0}};
  add_polygon(mesh, {3, 2, 1, 0});
  for (std::uint32_t i = 0; i < 4; ++i)
    add_polygon(mesh, {i, (i + 1) % 4, 4});
  round_to_float(mesh);
  return mesh;
}

Mesh make_prism() {
  Mesh mesh;
  const double s = kHalfSide, y = -kPyramidHeight;
  mesh.positions = {{-s, y, s}, {s, y, s}, {s, y, -s}, {-s, y, -s}, {0, 0, s}, {0, 0, -s}};
  add_polygon(mesh, {3, 2, 1, 0});
  add_polygon(mesh, {0, 1, 4});
  add_polygon(mesh, {1, 2, 5, 4});
  add_polygon(mesh, {2, 3, 5});
  add_polygon(mesh, {3, 0, 4, 5});
  round_to_float(mesh);
  return mesh;
}

}  // namespace palpa::assets
