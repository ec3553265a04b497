// The rates of afferents beside the pressure on a finger.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>

#include "experiment/afferents_task.hpp"
#include "experiment/skin_rates.hpp"
#include "setup/sessions/load.hpp"
#include "support/shapes.hpp"
#include "support/thrown.hpp"

namespace palpa::experiment {
namespace {

/// A ball for a fingertip, its lowest point at the world's origin, and a modulated focus there.
session::SkinQuestion question() {
  session::SkinQuestion q;
  q.finger = test::transformed(test::sphere(3e-3, 10, 16), [](const Vec3& p) { return p + Vec3(0, 3e-3, 0); });
  q.layout = setup::load_posed_layout("openmpd");
  q.air = acoustics::air_of({});
  q.afferents = true;
  array::Voice& voice = q.plan.schedule.add_voice();
  voice.foci = {Vec3(0)};
  voice.order = {0};
  voice.modulation_hz = 200;
  session::SlotWork work;
  array::SlotDrives slots;
  session::drive_on_host(q.plan, q.layout, q.drive, work, nullptr, slots);
  return q;
}

constexpr std::size_t pc = 2;

struct SkinRatesTest : testing::Test {
  acoustics::BodyCache bodies;
  SkinRates rates;
  session::SkinQuestion q = question();

  session::SkinAnswer answer() { return rates.answer(q, bodies); }
};

TEST_F(SkinRatesTest, AreBesideThePressure) {
  const session::SkinAnswer felt = answer();
  ASSERT_EQ(felt.rates.size(), q.finger.positions.size());
  EXPECT_EQ(felt.vertices, session::answer(q, bodies).vertices);
  EXPECT_EQ(bodies.made(), 1u) << "one set of equations for both";
  const auto most = std::ranges::max_element(felt.rates, {}, [](const ByClass& at) { return at[pc]; });
  // At 200 Hz, Pacinian afferents fire once or twice in a period.
  EXPECT_GT((*most)[pc], 20);
  EXPECT_LT((*most)[pc], 450);
  for (const ByClass& at : felt.rates) {
    for (const double rate : at)
      ASSERT_GE(rate, 0);
  }
  q.afferents = false;
  EXPECT_TRUE(answer().rates.empty());
}

TEST_F(SkinRatesTest, DoNotDependOnTheMeshsOrigin) {
  const session::SkinAnswer felt = answer();
  for (Vec3& p : q.finger.positions)
    p += Vec3(4e-3, 70e-3, -2e-3);
  q.T_world_finger = glm::translate(Transform(1.0), Vec3(-4e-3, -70e-3, 2e-3));
  const session::SkinAnswer moved = answer();
  ASSERT_EQ(moved.rates.size(), felt.rates.size());
  // Rounding may move a spike.
  for (std::size_t v = 0; v < felt.rates.size(); ++v)
    EXPECT_NEAR(moved.rates[v][pc], felt.rates[v][pc], 4.1) << v;
}

TEST_F(SkinRatesTest, BeyondTheFingertipAreUnknown) {
  for (Vec3& p : q.finger.positions)
    p.y *= 5;  // 30 mm high
  const session::SkinAnswer felt = answer();
  for (std::size_t v = 0; v < felt.rates.size(); ++v)
    EXPECT_EQ(std::isnan(felt.rates[v][pc]), glm::length(q.finger.positions[v]) > observer::fingertip_reach_m) << v;
}

TEST_F(SkinRatesTest, OfSilenceAreZero) {
  q.plan = {};
  for (const ByClass& at : answer().rates)
    EXPECT_EQ(at, ByClass{});
}

TEST_F(SkinRatesTest, NeedALevel) {
  // An array whose middle is where the paper's cube would be touched.
  q.layout = array::transformed(q.layout, glm::translate(Transform(1.0), Vec3(0, 0.147, 0)));
  q.T_world_finger = glm::translate(Transform(1.0), Vec3(0, 0.1, 0));
  EXPECT_ERROR(answer(), Exit::bad_input, "the finger");
}

}  // namespace
}  // namespace palpa::experiment
