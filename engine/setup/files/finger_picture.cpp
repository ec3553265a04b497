#include "setup/files/finger_picture.hpp"

#include <algorithm>
#include <cmath>

#include "drawing/field_picture.hpp"

namespace palpa::setup {
namespace {

double column_below(double x) {
  return (x + below_half_m) / below_step_m - 0.5;
}
double row_below(double z) {
  return (below_half_m - z) / below_step_m - 0.5;
}
std::int64_t clamped_below(double at) {
  return static_cast<std::int64_t>(std::clamp(at, -1.0, static_cast<double>(below_side)));
}

}  // namespace

SeenFromBelow::SeenFromBelow(const geometry::Mesh& body, const Vec3& tip)
    : face(below_side * below_side, -1), y(below_side * below_side, 0) {
  for (std::size_t f = 0; f < body.triangles.size(); ++f) {
    const glm::uvec3& t = body.triangles[f];
    add(f, body.positions[t.x] - tip, body.positions[t.y] - tip, body.positions[t.z] - tip);
  }
  for (double& height : y)
    height += tip.y;
}

void SeenFromBelow::add(std::size_t f, const Vec3& a, const Vec3& b, const Vec3& c) {
  const double turn = (b.x - a.x) * (c.z - a.z) - (b.z - a.z) * (c.x - a.x);
  if (turn == 0) return;
  const auto [left, right] = std::minmax({column_below(a.x), column_below(b.x), column_below(c.x)});
  const auto [top, bottom] = std::minmax({row_below(a.z), row_below(b.z), row_below(c.z)});
  for (std::int64_t j = std::max<std::int64_t>(0, clamped_below(std::ceil(top)));
       j <= std::min<std::int64_t>(static_cast<std::int64_t>(below_side) - 1, clamped_below(bottom)); ++j) {
    for (std::int64_t i = std::max<std::int64_t>(0, clamped_below(std::ceil(left)));
         i <= std::min<std::int64_t>(static_cast<std::int64_t>(below_side) - 1, clamped_below(right)); ++i) {
      const double x = (static_cast<double>(i) + 0.5) * below_step_m - below_half_m;
      const double z = below_half_m - (static_cast<double>(j) + 0.5) * below_step_m;
      const double u = ((x - a.x) * (c.z - a.z) - (z - a.z) * (c.x - a.x)) / turn;
      const double v = ((b.x - a.x) * (z - a.z) - (b.z - a.z) * (x - a.x)) / turn;
      if (u < -1e-9 || v < -1e-9 || u + v > 1 + 1e-9) continue;
      const double height = a.y + u * (b.y - a.y) + v * (c.y - a.y);
      const std::size_t at = static_cast<std::size_t>(j) * below_side + static_cast<std::size_t>(i);
      if (face[at] >= 0 && y[at] <= height) continue;
      face[at] = static_cast<std::int64_t>(f);
      y[at] = height;
    }
  }
}

drawing::Pixels draw_from_below(const std::vector<double>& values, const std::string& title,
                                const std::vector<std::string>& notes, double most, const std::string& unit) {
  const drawing::FieldPicture picture{.values = values,
                                      .columns = static_cast<std::uint32_t>(below_side),
                                      .rows = static_cast<std::uint32_t>(below_side),
                                      .low_mm = Vec2(-below_half_m * 1e3),
                                      .high_mm = Vec2(below_half_m * 1e3),
                                      .right = "x",
                                      .up = "z",
                                      .title = title,
                                      .notes = notes,
                                      .most = most,
                                      .unit = unit};
  return drawing::draw(picture);
}

}  // namespace palpa::setup
