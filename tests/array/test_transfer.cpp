// The solvers' inputs: the free field's columns against its formula.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "columns.hpp"

namespace palpa::array {
namespace {

using Complex = std::complex<double>;

const std::vector<SlotFocus> foci{{{0.01, 0.02, 0.15}}, {{-0.03, 0, 0.1}}, {{0.02, -0.01, 0.2}}};

TEST(FreeField, ColumnsAreTheFormula) {
  const Layout layout = load_layout("openmpd");
  const double k = 2 * std::numbers::pi * Medium{}.turns_per_metre();
  for (const Directivity kind : {Directivity::omni, Directivity::piston, Directivity::t4010a1}) {
    const Columns columns = columns_of(layout, foci, Weighting::distance, kind);
    ASSERT_EQ(columns.foci, foci.size());
    ASSERT_EQ(columns.transducers, layout.transducers.size());
    for (std::size_t j = 0; j < foci.size(); ++j) {
      const double farthest = farthest_of(layout, foci[j].position);
      for (std::size_t n = 0; n < columns.transducers; ++n) {
        const Vec3 way = foci[j].position - layout.transducers[n].position;
        const double d = glm::length(way);
        const double loud =
            directivity(kind, glm::dot(way, layout.transducers[n].axis) / d, k * layout.transducer_radius_m) / d;
        const std::size_t entry = n * foci.size() + j;
        ASSERT_LE(std::abs(columns.transfer(entry) - std::polar(loud, k * d)), 5e-5 / d);
        ASSERT_LE(std::abs(columns.ask(entry) - std::polar(d / farthest, -k * d)), 1e-10);
      }
    }
  }
  for (const double asked : columns_of(layout, foci, Weighting::uniform, Directivity::omni).asked)
    ASSERT_EQ(asked, 1);
}

}  // namespace
}  // namespace palpa::array
