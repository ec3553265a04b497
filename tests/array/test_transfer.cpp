// The solvers' inputs: the free field's columns against its formula, R against sums computed here.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "array/free_field.hpp"

namespace palpa::array {
namespace {

using Complex = std::complex<double>;

std::vector<FocusSource> some_foci(const Layout& layout) {
  std::vector<FocusSource> foci{{{0.01, 0.02, 0.15}, 0, 1}, {{-0.03, 0, 0.1}, 0, 1}, {{0.02, -0.01, 0.2}, 0, 1}};
  for (FocusSource& focus : foci) {
    for (const Transducer& t : layout.transducers)
      focus.farthest = std::max(focus.farthest, glm::distance(t.position, focus.position));
  }
  return foci;
}

TEST(FreeField, ColumnsAreTheFormula) {
  const Layout layout = load_layout("openmpd");
  const Medium medium;
  const auto foci = some_foci(layout);
  FreeField field;
  Columns columns;
  for (const Directivity kind : {Directivity::omni, Directivity::piston, Directivity::t4010a1}) {
    field.set(layout, medium, kind);
    field.fill(foci, Weighting::distance, columns);
    ASSERT_EQ(columns.foci, foci.size());
    ASSERT_EQ(columns.transducers, layout.transducers.size());
    const double k = 2 * std::numbers::pi * medium.turns_per_metre();
    for (std::size_t n = 0; n < columns.transducers; ++n) {
      for (std::size_t j = 0; j < foci.size(); ++j) {
        const Vec3 way = foci[j].position - layout.transducers[n].position;
        const double d = glm::length(way);
        const double loud =
            directivity(kind, glm::dot(way, layout.transducers[n].axis) / d, k * layout.transducer_radius_m) / d;
        const std::size_t entry = n * foci.size() + j;
        ASSERT_LE(std::abs(columns.transfer(entry) - std::polar(loud, k * d)), 5e-5 / d);
        ASSERT_LE(std::abs(columns.ask(entry) - std::polar(d / foci[j].farthest, -k * d)), 1e-10);
      }
    }
  }
}

TEST(FreeField, AnEvenWeightingAsksForAll) {
  const Layout layout = load_layout("openmpd");
  FreeField field;
  field.set(layout, {}, Directivity::omni);
  Columns columns;
  field.fill(some_foci(layout), Weighting::uniform, columns);
  for (const double asked : columns.asked)
    ASSERT_EQ(asked, 1);
}

TEST(FocusMatrix, IsWhatArrivesOfWhatIsAsked) {
  const Layout layout = load_layout("openmpd");
  FreeField field;
  field.set(layout, {}, Directivity::t4010a1);
  Columns columns;
  field.fill(some_foci(layout), Weighting::distance, columns);
  FocusMatrix matrix;
  // Twice: it reuses its storage, but none of the old contents.
  for (int time = 0; time < 2; ++time)
    multiply(columns, matrix);
  ASSERT_EQ(matrix.foci, 3u);
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 3; ++column) {
      Complex sum = 0;
      for (std::size_t n = 0; n < columns.transducers; ++n)
        sum += columns.transfer(n * 3 + row) * columns.ask(n * 3 + column);
      EXPECT_LE(std::abs(matrix.at(row, column) - sum), 1e-9 * std::abs(matrix.alone(row)));
    }
    EXPECT_NEAR(matrix.alone(row), matrix.at(row, row).real(), 0);
    EXPECT_NEAR(matrix.at(row, row).imag(), 0, 1e-9 * matrix.alone(row));
  }
}

}  // namespace
}  // namespace palpa::array
