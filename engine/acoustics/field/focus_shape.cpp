#include "acoustics/field/focus_shape.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

namespace palpa::acoustics {

array::Layout square_board(int count, double pitch_m) {
  array::Layout layout;
  const double middle = (count - 1) / 2.0;
  for (int row = 0; row < count; ++row) {
    for (int column = 0; column < count; ++column)
      layout.transducers.push_back({{pitch_m * (column - middle), pitch_m * (row - middle), 0}, {0, 0, 1}});
  }
  return layout;
}

double focus_width(const Incident& incident, const Strengths& strengths, const Vec3& focus, const Vec3& along) {
  constexpr double step = 2e-5;
  std::vector<Vec3> line;
  for (int i = -400; i <= 400; ++i)
    line.push_back(focus + along * (step * i));
  Waves waves;
  incident.at(line, {}, strengths, waves);
  std::vector<double> sizes;
  for (const std::complex<double>& p : waves.pressures)
    sizes.push_back(std::abs(p));
  const auto peak = std::ranges::max_element(sizes);
  auto low = peak, high = peak;
  while (low != sizes.begin() && *low > *peak / 2)
    --low;
  while (high + 1 != sizes.end() && *high > *peak / 2)
    ++high;
  return step * static_cast<double>(high - low - 1);
}

double disc_force(const Incident& incident, const Strengths& strengths, const Air& air, const Vec3& focus,
                  double radius_m) {
  constexpr int rings = 40, around = 24;
  std::vector<Vec3> points;
  std::vector<double> areas;
  for (int i = 0; i < rings; ++i) {
    for (int j = 0; j < around; ++j) {
      const double r = radius_m * (i + 0.5) / rings, angle = 2 * std::numbers::pi * j / around;
      points.push_back(focus + r * Vec3(std::cos(angle), std::sin(angle), 0));
      areas.push_back(2 * std::numbers::pi * r * radius_m / rings / around);
    }
  }
  Waves waves;
  incident.at(points, {}, strengths, waves);
  double newtons = 0;
  for (std::size_t i = 0; i < areas.size(); ++i)
    newtons += areas[i] * std::norm(waves.pressures[i]) / air.stiffness_pa();
  return newtons;
}

}  // namespace palpa::acoustics
