#include "array/layouts/as_built.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace palpa::array {
namespace {

const Layout& board() {
  static const Layout layout = load_layout("openmpd");
  return layout;
}

Drive drive_of(float amplitude, float phase) {
  return Drive(board().transducers.size(), {amplitude, phase});
}

/// Standard deviation of numbers whose mean is 0.
double deviation(const std::vector<double>& values) {
  double squares = 0;
  for (const double value : values)
    squares += value * value;
  return std::sqrt(squares / static_cast<double>(values.size()));
}

TEST(AsBuilt, HasTheStandardDeviationsOfItsSpread) {
  const Spread spread{.amplitude = 0.1, .phase_rad = 0.3, .position_m = 5e-4, .temperature = 2};
  std::vector<double> amplitude, phase, temperature, off[3];
  for (std::uint32_t draw = 0; draw < 400; ++draw) {
    const AsBuilt built = as_built(board(), drive_of(0.5F, 1), spread, 3, draw);
    temperature.push_back(built.temperature);
    for (std::size_t t = 0; t < built.drive.size(); ++t) {
      amplitude.push_back(built.drive[t].amplitude / 0.5 - 1);
      phase.push_back(built.drive[t].phase - 1);
      for (int axis = 0; axis < 3; ++axis)
        off[axis].push_back(built.layout.transducers[t].position[axis] - board().transducers[t].position[axis]);
    }
  }
  EXPECT_NEAR(deviation(temperature), 2, 2 * 0.12);
  EXPECT_NEAR(deviation(amplitude), 0.1, 0.001);
  EXPECT_NEAR(deviation(phase), 0.3, 0.003);
  for (const std::vector<double>& along : off)
    EXPECT_NEAR(deviation(along), 5e-4, 5e-6);
}

TEST(AsBuilt, DependsOnSeedAndNumberOnly) {
  const Spread spread{.amplitude = 0.1};
  const auto first = [&](std::uint64_t seed, std::uint32_t draw) {
    return as_built(board(), drive_of(1, 0), spread, seed, draw).drive[0].amplitude;
  };
  EXPECT_EQ(first(5, 17), first(5, 17));
  EXPECT_NE(first(5, 17), first(5, 18));
  EXPECT_NE(first(5, 17), first(6, 17));
  // A seed's draws are no other seed's draws, moved by some places.
  EXPECT_NE(first(5, 18), first(6, 17));
}

/// One can switch a tolerance on and off and see its own share.
TEST(AsBuilt, EachDeviationHasItsOwnNumbers) {
  const Drive drive = drive_of(0.5F, 1);
  const AsBuilt all = as_built(board(), drive, {0.1, 0.2, 1e-3, 3}, 9, 2);
  const AsBuilt phases = as_built(board(), drive, {.phase_rad = 0.2}, 9, 2);
  const AsBuilt places = as_built(board(), drive, {.position_m = 2e-3}, 9, 2);
  EXPECT_EQ(as_built(board(), drive, {.temperature = 3}, 9, 2).temperature, all.temperature);
  EXPECT_EQ(phases.temperature, 0);
  for (std::size_t t = 0; t < drive.size(); ++t) {
    EXPECT_EQ(phases.drive[t].phase, all.drive[t].phase);
    EXPECT_EQ(phases.drive[t].amplitude, 0.5F);
    EXPECT_EQ(phases.layout.transducers[t].position, board().transducers[t].position);
    EXPECT_EQ(places.drive[t].phase, 1.0F);
    const Vec3 off = all.layout.transducers[t].position - board().transducers[t].position;
    const Vec3 twice = places.layout.transducers[t].position - board().transducers[t].position;
    EXPECT_NEAR(glm::length(twice - 2.0 * off), 0, 1e-15);
  }
}

}  // namespace
}  // namespace palpa::array
