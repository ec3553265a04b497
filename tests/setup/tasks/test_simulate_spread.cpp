// `palpa simulate --spread`: ranges of the pressures on a body, against the same draws computed one by one with
// equations of their own, and against a formula.
#include "setup/tasks/simulate_spread.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

#include "acoustics/bodies/radiation.hpp"
#include "acoustics/field/incident.hpp"
#include "array/drive.hpp"
#include "array/layouts/as_built.hpp"
#include "geometry/mesh/icosphere.hpp"
#include "session/previews/skin_as_built.hpp"
#include "session/previews/skin_pressure.hpp"
#include "support/shapes.hpp"

namespace palpa::test {
namespace {

using array::Spread;
using setup::Draws;
using setup::Percentiles;
using setup::SimulateSpread;

/// A ball above a board, with two foci on its underside that play one after the other.
struct Ball {
  array::Layout layout = array::load_layout("openmpd");
  setup::MediumOptions medium;
  setup::AirOptions air;
  std::shared_ptr<const acoustics::RigidBody> body;
  session::Sounds sounds;

  Ball() {
    const geometry::Mesh mesh =
        transformed(geometry::icosphere(4e-3, 4), [](const Vec3& p) { return p + Vec3(2e-3, 0, 0.1); });
    body = std::make_shared<const acoustics::RigidBody>(mesh, setup::air(medium, air).wave_number());
    for (const double x : {0.0, 3e-3}) {
      array::SlotFocus focus;
      focus.position = {x, 0, 0.096};
      const acoustics::Strengths own = acoustics::strengths_of(array::drive_for(layout, {&focus, 1}));
      sounds.strengths.insert(sounds.strengths.end(), own.begin(), own.end());
      sounds.weights.push_back(0.5);
    }
  }
  SimulateSpread with(const Spread& spread, const Draws& draws) const {
    return setup::spread_of_pressure({.sounds = sounds,
                                      .layout = layout,
                                      .directivity = array::Directivity::t4010a1,
                                      .medium = medium,
                                      .air = air,
                                      .body = body},
                                     spread, draws);
  }
};

acoustics::SkinPressure as_designed(const Ball& ball) {
  const acoustics::Air air = setup::air(ball.medium, ball.air);
  const acoustics::Incident incident(ball.layout, air, array::Directivity::t4010a1);
  return session::mean_pressure(ball.sounds, incident, air, *ball.body);
}

TEST(SimulateSpread, IsTheDesignWhereNothingVaries) {
  const Ball ball;
  const acoustics::SkinPressure designed = as_designed(ball);
  const acoustics::Spot spot = acoustics::spot_of(ball.body->mesh(), designed.squared);
  const SimulateSpread spread = ball.with({}, {20, 1});
  for (const double Percentiles::*part : {&Percentiles::p05, &Percentiles::p50, &Percentiles::p95}) {
    EXPECT_DOUBLE_EQ(spread.squared.peak_pa.*part, spot.peak_pa);
    EXPECT_DOUBLE_EQ(spread.squared.peak_m[2].*part, spot.peak_at.z);
    EXPECT_DOUBLE_EQ(spread.squared.half_area_m2.*part, spot.half_area_m2);
    EXPECT_DOUBLE_EQ(spread.squared.half_radius_m.*part, spot.half_radius_m);
    EXPECT_DOUBLE_EQ(spread.squared.elongation.*part, spot.elongation);
    EXPECT_DOUBLE_EQ(spread.force[2].*part, designed.langevin_load.force.z);
    EXPECT_DOUBLE_EQ(spread.torque[1].*part, designed.langevin_load.torque.y);
  }
}

/// The numbers of all draws, each with the equations for its own air.
struct OneByOne {
  std::vector<double> peaks, forces, torques;

  OneByOne(const Ball& ball, const Spread& spread, const Draws& draws) {
    const array::Drive unit(ball.layout.transducers.size(), {1, 0});
    for (std::uint32_t draw = 0; draw < draws.count; ++draw) {
      const array::AsBuilt built = array::as_built(ball.layout, unit, spread, draws.seed, draw);
      const acoustics::Air air = setup::air(setup::warmer(ball.medium, built.temperature), ball.air);
      const acoustics::RigidBody body(ball.body->mesh(), air.wave_number());
      session::Sounds sounds = ball.sounds;
      const acoustics::Strengths factors = acoustics::strengths_of(built.drive);
      for (std::size_t i = 0; i < sounds.strengths.size(); ++i)
        sounds.strengths[i] *= factors[i % factors.size()];
      const acoustics::Incident incident(built.layout, air, array::Directivity::t4010a1);
      const acoustics::SkinPressure pressure = session::mean_pressure(sounds, incident, air, body);
      peaks.push_back(acoustics::spot_of(body.mesh(), pressure.langevin).peak_pa);
      forces.push_back(pressure.langevin_load.force.z);
      torques.push_back(acoustics::about({0, 0, 0.1}, pressure.langevin_load).torque.y);
    }
  }
};

void expect_near(const Percentiles& found, const Percentiles& expected, double most) {
  EXPECT_NEAR(found.p05, expected.p05, most);
  EXPECT_NEAR(found.p50, expected.p50, most);
  EXPECT_NEAR(found.p95, expected.p95, most);
}

TEST(SimulateSpread, IsThatOfTheDrawsOneByOne) {
  const Ball ball;
  const Spread spread{.amplitude = 0.1, .phase_rad = 0.2, .position_m = 3e-4, .temperature = 3};
  const Draws draws{30, 5};
  const OneByOne each(ball, spread, draws);
  const SimulateSpread found = setup::spread_of_pressure({.sounds = ball.sounds,
                                                          .layout = ball.layout,
                                                          .directivity = array::Directivity::t4010a1,
                                                          .medium = ball.medium,
                                                          .air = ball.air,
                                                          .body = ball.body,
                                                          .tip = {0, 0, 0.1}},
                                                         spread, draws);
  const Percentiles peak = setup::percentiles(each.peaks), force = setup::percentiles(each.forces),
                    torque = setup::percentiles(each.torques);
  // Between temperatures, results are interpolated.
  expect_near(found.langevin.peak_pa, peak, 1e-3 * peak.p50);
  expect_near(found.force[2], force, 1e-3 * force.p50);
  expect_near(found.torque[1], torque, 2e-3 * std::abs(torque.p50));
  EXPECT_LT(force.p05, 0.98 * force.p95);
}

/// Phases with the deviation s leave e^{-s^2/2} of a focus's pressure, and e^{-s^2} of its radiation pressure.
TEST(SimulateSpread, OfPhasesFollowsTheFormula) {
  const Ball ball;
  const acoustics::Spot spot = acoustics::spot_of(ball.body->mesh(), as_designed(ball).langevin);
  const SimulateSpread spread = ball.with({.phase_rad = 0.3}, {100, 2});
  EXPECT_NEAR(spread.langevin.peak_pa.p50 / spot.peak_pa, std::exp(-0.09), 0.02);
  EXPECT_LT(spread.langevin.peak_pa.p95, spot.peak_pa);
}

/// At the end of the range of temperatures, some of the five coincide.
TEST(SimulateSpread, StaysWithinTheRangeOfTemperatures) {
  Ball ball;
  ball.medium.celsius = array::most_celsius;
  ball.body =
      std::make_shared<const acoustics::RigidBody>(ball.body->mesh(), setup::air(ball.medium, ball.air).wave_number());
  const Spread spread{.temperature = 20};
  const Draws draws{20, 3};
  const Percentiles force = setup::percentiles(OneByOne(ball, spread, draws).forces);
  expect_near(ball.with(spread, draws).force[2], force, 0.02 * force.p50);
}

}  // namespace
}  // namespace palpa::test
