#include "setup/tasks/simulate_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "drawing/field_picture.hpp"

namespace palpa::setup {
namespace {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t side = 240;  // samples along each axis
constexpr double half_m = 11e-3;   // visible range on either side of the tip
constexpr double step_m = 2 * half_m / side;

/// A body seen from below, x to the right and z upwards. For each sample: the face, and the height of the skin.
struct SeenFromBelow {
  std::vector<std::int64_t> face = std::vector<std::int64_t>(side * side, -1);
  std::vector<double> y = std::vector<double>(side * side, 0);

  explicit SeenFromBelow(const SimulateResult& result) {
    for (std::size_t f = 0; f < result.body.triangles.size(); ++f) {
      const glm::uvec3& t = result.body.triangles[f];
      add(f, result.body.positions[t.x] - result.tip, result.body.positions[t.y] - result.tip,
          result.body.positions[t.z] - result.tip);
    }
    for (double& height : y)
      height += result.tip.y;
  }

 private:
  static double column(double x) { return (x + half_m) / step_m - 0.5; }
  static double row(double z) { return (half_m - z) / step_m - 0.5; }
  static std::int64_t clamped(double at) {
    return static_cast<std::int64_t>(std::clamp(at, -1.0, static_cast<double>(side)));
  }

  void add(std::size_t f, const Vec3& a, const Vec3& b, const Vec3& c) {
    const double turn = (b.x - a.x) * (c.z - a.z) - (b.z - a.z) * (c.x - a.x);
    if (turn == 0) return;
    const auto [left, right] = std::minmax({column(a.x), column(b.x), column(c.x)});
    const auto [top, bottom] = std::minmax({row(a.z), row(b.z), row(c.z)});
    for (std::int64_t j = std::max<std::int64_t>(0, clamped(std::ceil(top)));
         j <= std::min<std::int64_t>(static_cast<std::int64_t>(side) - 1, clamped(bottom)); ++j) {
      for (std::int64_t i = std::max<std::int64_t>(0, clamped(std::ceil(left)));
           i <= std::min<std::int64_t>(static_cast<std::int64_t>(side) - 1, clamped(right)); ++i) {
        const double x = (static_cast<double>(i) + 0.5) * step_m - half_m;
        const double z = half_m - (static_cast<double>(j) + 0.5) * step_m;
        const double u = ((x - a.x) * (c.z - a.z) - (z - a.z) * (c.x - a.x)) / turn;
        const double v = ((b.x - a.x) * (z - a.z) - (b.z - a.z) * (x - a.x)) / turn;
        if (u < -1e-9 || v < -1e-9 || u + v > 1 + 1e-9) continue;
        const double height = a.y + u * (b.y - a.y) + v * (c.y - a.y);
        const std::size_t at = static_cast<std::size_t>(j) * side + static_cast<std::size_t>(i);
        if (face[at] >= 0 && y[at] <= height) continue;
        face[at] = static_cast<std::int64_t>(f);
        y[at] = height;
      }
    }
  }
};

drawing::Pixels draw(const std::vector<double>& values, const std::string& title, const std::vector<std::string>& notes,
                     double most, const std::string& unit) {
  const drawing::FieldPicture picture{.values = values,
                                      .columns = static_cast<std::uint32_t>(side),
                                      .rows = static_cast<std::uint32_t>(side),
                                      .low_mm = Vec2(-half_m * 1e3),
                                      .high_mm = Vec2(half_m * 1e3),
                                      .right = "x",
                                      .up = "z",
                                      .title = title,
                                      .notes = notes,
                                      .most = most,
                                      .unit = unit};
  return drawing::draw(picture);
}

/// Marks the samples of a cross around a focus.
void cross_out(std::vector<double>& values, const Vec3& from_tip) {
  constexpr int arm = 4;
  const int column = static_cast<int>(std::lround((from_tip.x + half_m) / step_m - 0.5));
  const int row = static_cast<int>(std::lround((half_m - from_tip.z) / step_m - 0.5));
  for (int i = -arm; i <= arm; ++i) {
    for (const auto& [x, y] : {std::pair(column + i, row), std::pair(column, row + i)}) {
      if (x >= 0 && y >= 0 && x < static_cast<int>(side) && y < static_cast<int>(side))
        values[static_cast<std::size_t>(y) * side + static_cast<std::size_t>(x)] = nothing;
    }
  }
}

}  // namespace

drawing::Pixels foci_picture(const SimulateResult& result, double top_y, const std::string& title) {
  const SeenFromBelow seen(result);
  std::vector<double> values(side * side, nothing);
  double most = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (seen.face[i] < 0) continue;
    values[i] = std::max(0.0, (top_y - seen.y[i]) * 1e3);
    most = std::max(most, values[i]);
  }
  for (const std::optional<Vec3>& focus : result.foci) {
    if (focus) cross_out(values, *focus - result.tip);
  }
  return draw(values, title, {"the finger from below; crosses: foci"}, most, "mm below the top");
}

drawing::Pixels pressure_picture(const SimulateResult& result, const std::string& title) {
  const SeenFromBelow seen(result);
  std::vector<double> values(side * side, nothing);
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (seen.face[i] < 0) continue;
    values[i] =
        std::max(0.0, result.pressure.langevin[static_cast<std::size_t>(seen.face[i])] / result.langevin.peak_pa);
  }
  std::vector<std::string> notes{fmt::format("time average; the largest is {:.0f} Pa", result.langevin.peak_pa)};
  if (result.beyond_linear()) {
    notes.push_back(
        fmt::format("Beyond linear acoustics: the linear sum reaches {:.0f} kPa", result.pressure.loudest_pa / 1e3));
  }
  return draw(values, title, notes, 1, "of the largest");
}

}  // namespace palpa::setup
