#include "setup/tasks/simulate_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "setup/files/finger_picture.hpp"

namespace palpa::setup {
namespace {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

/// Marks the samples of a cross around a focus.
void cross_out(std::vector<double>& values, const Vec3& from_tip) {
  constexpr int arm = 4;
  const int column = static_cast<int>(std::lround((from_tip.x + below_half_m) / below_step_m - 0.5));
  const int row = static_cast<int>(std::lround((below_half_m - from_tip.z) / below_step_m - 0.5));
  for (int i = -arm; i <= arm; ++i) {
    for (const auto& [x, y] : {std::pair(column + i, row), std::pair(column, row + i)}) {
      if (x >= 0 && y >= 0 && x < static_cast<int>(below_side) && y < static_cast<int>(below_side))
        values[static_cast<std::size_t>(y) * below_side + static_cast<std::size_t>(x)] = nothing;
    }
  }
}

}  // namespace

drawing::Pixels foci_picture(const SimulateResult& result, double top_y, const std::string& title) {
  const SeenFromBelow seen(result.body, result.tip);
  std::vector<double> values(below_side * below_side, nothing);
  double most = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (seen.face[i] < 0) continue;
    values[i] = std::max(0.0, (top_y - seen.y[i]) * 1e3);
    most = std::max(most, values[i]);
  }
  for (const std::optional<Vec3>& focus : result.foci) {
    if (focus) cross_out(values, *focus - result.tip);
  }
  return draw_from_below(values, title, {"the finger from below; crosses: foci"}, most, "mm below the top");
}

drawing::Pixels pressure_picture(const SimulateResult& result, const std::string& title) {
  const SeenFromBelow seen(result.body, result.tip);
  std::vector<double> values(below_side * below_side, nothing);
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
  return draw_from_below(values, title, notes, 1, "of the largest");
}

}  // namespace palpa::setup
