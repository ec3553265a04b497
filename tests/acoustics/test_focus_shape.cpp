// How large, how far and how strong a focus is: what the formulas give for arrays that others have measured or
// reckoned.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "acoustics/incident.hpp"

namespace palpa::acoustics {
namespace {

using namespace array;

std::vector<double> amplitudes(const Layout& layout, const DriveOptions& options, const Vec3& focus,
                               Directivity directivity, const std::vector<Vec3>& points) {
  const SlotFocus foci[]{{focus, 1}};
  Waves waves;
  Incident(layout, air_of({}), directivity).at(points, {}, strengths_of(drive_for(layout, foci, options)), waves);
  std::vector<double> sizes;
  for (const std::complex<double>& p : waves.pressures)
    sizes.push_back(std::abs(p));
  return sizes;
}

/// Full width at half maximum of |p| along a line through the focus, metres.
double width(const Layout& layout, const DriveOptions& options, const Vec3& focus, Directivity directivity,
             const Vec3& along) {
  constexpr double step = 2e-5;
  std::vector<Vec3> line;
  for (int i = -400; i <= 400; ++i)
    line.push_back(focus + along * (step * i));
  const std::vector<double> sizes = amplitudes(layout, options, focus, directivity, line);
  const auto peak = std::ranges::max_element(sizes);
  auto low = peak, high = peak;
  while (low != sizes.begin() && *low > *peak / 2)
    --low;
  while (high + 1 != sizes.end() && *high > *peak / 2)
    ++high;
  return step * static_cast<double>(high - low - 1);
}

TEST(FocusShape, ThePapersIsFourByNineMillimetres) {
  const Layout layout = load_layout("paper");
  for (const Vec3& across : {Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(std::sqrt(0.5), std::sqrt(0.5), 0)}) {
    const double fwhm = width(layout, {}, Vec3(0), Directivity::t4010a1, across);
    EXPECT_GT(fwhm, 4.3e-3);
    EXPECT_LT(fwhm, 4.8e-3);
  }
  const double along = width(layout, {}, Vec3(0), Directivity::t4010a1, {0, 0, 1});
  EXPECT_GT(along, 8e-3);
  EXPECT_LT(along, 9.5e-3);
}

/// 18 x 18 transducers, as Hoshi et al. (2010) had them.
TEST(FocusShape, AFlatArraysIsAsMeasured) {
  Layout layout;
  layout.source_level_pa_m = 3.4;
  layout.transducer_radius_m = 4.5e-3;
  for (int row = 0; row < 18; ++row) {
    for (int column = 0; column < 18; ++column)
      layout.transducers.push_back({{0.01016 * (column - 8.5), 0.01016 * (row - 8.5), 0}, {0, 0, 1}});
  }
  DriveOptions full;
  full.constraint = Constraint::uniform;
  const Vec3 focus(0, 0, 0.2);
  const double fwhm = width(layout, full, focus, Directivity::piston, {1, 0, 0});
  EXPECT_GT(fwhm, 12.3e-3);
  EXPECT_LT(fwhm, 13.2e-3);

  // What a wall that reflects all of it would feel on a disc of 20 mm: they measured 16 mN.
  constexpr int rings = 40, around = 24;
  constexpr double radius = 10e-3;
  std::vector<Vec3> points;
  std::vector<double> areas;
  for (int i = 0; i < rings; ++i) {
    for (int j = 0; j < around; ++j) {
      const double r = radius * (i + 0.5) / rings, angle = 2 * std::numbers::pi * j / around;
      points.push_back(focus + r * Vec3(std::cos(angle), std::sin(angle), 0));
      areas.push_back(2 * std::numbers::pi * r * radius / rings / around);
    }
  }
  const std::vector<double> sizes = amplitudes(layout, full, focus, Directivity::piston, points);
  double newtons = 0;
  for (std::size_t i = 0; i < sizes.size(); ++i)
    newtons += areas[i] * sizes[i] * sizes[i] / air_of({}).stiffness_pa();
  EXPECT_NEAR(newtons, 16e-3, 0.3 * 16e-3);
}

/// A flat array is loudest nearer than where it is focused.
TEST(FocusShape, AFlatArraysIsNearerThanCommanded) {
  const Layout layout = load_layout("openmpd");
  std::vector<Vec3> line;
  for (int i = 0; i <= 2000; ++i)
    line.emplace_back(0, 0, 0.14 + 1e-5 * i);
  const struct {
    Directivity directivity;
    double loudest_m;
  } known[]{{Directivity::omni, 145.7e-3}, {Directivity::t4010a1, 146.6e-3}, {Directivity::piston, 147.4e-3}};
  for (const auto& [directivity, loudest_m] : known) {
    const std::vector<double> sizes = amplitudes(layout, {}, {0, 0, 0.15}, directivity, line);
    const auto at = static_cast<std::size_t>(std::ranges::max_element(sizes) - sizes.begin());
    EXPECT_NEAR(line[at].z, loudest_m, 0.1e-3);
  }
}

}  // namespace
}  // namespace palpa::acoustics
