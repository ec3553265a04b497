// Size, distance and strength of a focus: the formulas' results for arrays that others have measured or computed.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <vector>

#include "acoustics/field/focus_shape.hpp"
#include "acoustics/field/incident.hpp"
#include "array/amplitudes.hpp"
#include "array/drive.hpp"
#include "array/drive_options.hpp"

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

double width(const Layout& layout, const DriveOptions& options, const Vec3& focus, Directivity directivity,
             const Vec3& along) {
  const SlotFocus foci[]{{focus, 1}};
  return focus_width(Incident(layout, air_of({}), directivity), strengths_of(drive_for(layout, foci, options)), focus,
                     along);
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

/// 18 x 18 transducers, as in Hoshi et al. (2010).
TEST(FocusShape, AFlatArraysIsAsMeasured) {
  Layout layout = square_board(18, 10.16e-3);
  layout.source_level_pa_m = 3.4;
  layout.transducer_radius_m = 4.5e-3;
  DriveOptions full;
  full.weighting = array::Weighting::uniform;
  const Vec3 focus(0, 0, 0.2);
  const double fwhm = width(layout, full, focus, Directivity::piston, {1, 0, 0});
  EXPECT_GT(fwhm, 12.3e-3);
  EXPECT_LT(fwhm, 13.2e-3);

  // The force that a fully reflecting wall would feel on a disc of 20 mm: they measured 16 mN.
  const SlotFocus foci[]{{focus, 1}};
  const double newtons = disc_force(Incident(layout, air_of({}), Directivity::piston),
                                    strengths_of(drive_for(layout, foci, full)), air_of({}), focus, 10e-3);
  EXPECT_NEAR(newtons, 16e-3, 0.3 * 16e-3);
}

/// A flat array is loudest nearer than its focal point.
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
