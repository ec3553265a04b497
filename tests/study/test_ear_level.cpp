// The predicted level at a participant's ears.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "acoustics/air.hpp"
#include "acoustics/field/pressure.hpp"
#include "array/drive.hpp"
#include "study/plan/plan_file.hpp"
#include "study/sitting/ear_level.hpp"
#include "study/sitting/heard_level.hpp"
#include "support/boards.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa::study {
namespace {

StudyPlan plan_on(const std::string& layout, double ceiling = 1) {
  StudyPlan plan = read_plan(test::source_file("assets/studies/paper.toml"));
  for (PlanMethod& method : plan.methods)
    method.layout = layout;
  plan.level.ceiling = ceiling;
  if (layout == "openmpd") plan.level.ears = {Vec3(-0.08, 0.3, 0.4), Vec3(0.08, 0.3, 0.4)};
  return plan;
}

/// Around the paper's cube.
const Box cube{{-0.02, -0.04, -0.02}, {0.02, 0, 0.02}};

EarLevel level_of(const StudyPlan& plan, const Box& object = cube) {
  return predict_ear_level(plan, std::vector<Box>(plan.shapes.size(), object));
}

/// The level of a board at full amplitude. All tests share it, because it takes a while to compute.
const EarLevel& full_level() {
  static const EarLevel level = level_of(plan_on("openmpd"));
  return level;
}

TEST(EarLevel, IsThatOfTheLoudestPlaceNearTheEar) {
  const StudyPlan plan = plan_on("openmpd");
  const EarLevel& level = full_level();
  // Another way: single points in double precision, for one of the foci.
  const array::Layout own = array::load_layout("openmpd");
  const array::Layout layout = array::transformed(own, own.default_T_world_layout);
  const acoustics::Air air = acoustics::air_of({});
  array::SlotFocus focus;
  focus.position = Vec3(0, 0, 0);
  const array::Drive drive = array::drive_for(layout, {&focus, 1});
  for (std::size_t side = 0; side < 2; ++side) {
    const double at_ear = std::abs(acoustics::pressure_at(layout, drive, plan.level.ears[side], air.medium,
                                                          array::Directivity::t4010a1, air.absorption_np_m));
    const double db = 20 * std::log10(at_ear / std::sqrt(2.0) / 20e-6);
    EXPECT_GE(level.db[side], db - 1e-3);
    EXPECT_LT(level.db[side], db + 25);
    EXPECT_GT(level.db[side], 90);
    EXPECT_LT(level.db[side], 140);
  }
  // The board and the ears are mirror images of themselves; the sampled places are not.
  EXPECT_NEAR(level.db[0], level.db[1], 1.5);
  EXPECT_EQ(level.layout, "openmpd");
}

TEST(EarLevel, FollowsTheCeilingAndTheMinutes) {
  const EarLevel &full = full_level(), tenth = level_of(plan_on("openmpd", 0.1));
  EXPECT_NEAR(full.loudest_db() - tenth.loudest_db(), 20, 0.3) << "the board has four amplitudes up to 0.1";
  // If a model asks for a pressure, all transducers play the highest step that is not above the ceiling.
  const auto equal = [](double ceiling) {
    StudyPlan plan = plan_on("openmpd", ceiling);
    plan.shapes[0].asks_pressure = true;
    return level_of(plan);
  };
  const EarLevel all = equal(1);
  for (const auto& [ceiling, width] : {std::pair(0.1, 4), std::pair(0.12, 4), std::pair(0.04, 1), std::pair(0.03, 1)}) {
    const double step_db = 20 * std::log10(std::sin(width * std::numbers::pi / 128));
    const EarLevel level = equal(ceiling);
    EXPECT_NEAR(level.predicted_db(), all.predicted_db() + step_db, 1e-3) << ceiling;
    EXPECT_NEAR(level.bound_db, all.bound_db + step_db, 1e-3) << ceiling;
  }
  const StudyPlan plan = plan_on("openmpd");
  EXPECT_DOUBLE_EQ(full.sounding_s, sounding_s(plan));
  // Each method: 4 x 10 s, 180 s, 10 s, 40 x 10 s.
  EXPECT_DOUBLE_EQ(full.sounding_s, 2 * 630);
  EXPECT_NEAR(full.equivalent_db(), full.loudest_db() - 10 * std::log10(28800.0 / 1260), 1e-9);
}

/// One transducer that faces an ear at 0.5 m: every drive is its full amplitude. It has 4.386 Pa m / r, less what air
/// absorbs: at 0.4 m, the nearest place of the ball, 10.3 Pa, which is 111.25 dB. The nearest of the places that are
/// tried is up to a centimetre farther away.
TEST(EarLevel, OfOneTransducerIsWorkedOut) {
  array::Layout one;
  one.name = "one";
  one.transducers = {{Vec3(0, -0.2, 0), Vec3(0, 1, 0)}};
  const array::KnownLayout known(one);
  StudyPlan plan = plan_on(known.name());
  plan.level.ears = {Vec3(0, 0.3, 0), Vec3(0, 0.3, 0)};
  const EarLevel level = level_of(plan);
  EXPECT_NEAR(level.bound_db, 111.1, 0.16);
  for (const double db : level.db)
    EXPECT_NEAR(db, level.bound_db + untried_db, 1e-3);
  // Two of them beside each other are in phase somewhere, and then have twice the pressure.
  one.name = "two";
  one.transducers.push_back({Vec3(0.01, -0.2, 0), Vec3(0, 1, 0)});
  const array::KnownLayout known_two(one);
  for (PlanMethod& method : plan.methods)
    method.layout = known_two.name();
  const EarLevel two = level_of(plan);
  EXPECT_NEAR(two.bound_db - level.bound_db, 20 * std::log10(2.0), 0.05);
  EXPECT_LE(two.predicted_db(), two.bound_db + untried_db);
  EXPECT_GT(two.predicted_db(), two.bound_db - 1);
}

TEST(HeardLevel, IsThatOfTheEarThatIsNearer) {
  array::Layout one;
  one.name = "one that is heard";
  one.transducers = {{Vec3(0, -0.2, 0), Vec3(0, 1, 0)}};
  const array::KnownLayout known(one);
  StudyPlan plan = plan_on(known.name());
  const auto dba = [&](double left_m, double right_m) {
    plan.level.ears = {Vec3(0, left_m - 0.2, 0), Vec3(0, right_m - 0.2, 0)};
    return predict_heard_level(plan, {&cube, 1}).high_dba;
  };
  const double near = dba(0.4, 0.4);
  EXPECT_GT(near, dba(0.9, 0.9) + 3);
  EXPECT_DOUBLE_EQ(dba(0.4, 0.9), near) << "the left ear";
  EXPECT_DOUBLE_EQ(dba(0.9, 0.4), near) << "the right ear";
}

/// A board whose own clock modulates plays a focus that stands still by it, whatever the dwell.
TEST(HeardLevel, OfAModulatedFocusFollowsTheBoardsClock) {
  const auto dba = [](touch::Method method, double dwell_s) {
    StudyPlan plan = plan_on("autd3");
    plan.methods.resize(1);
    plan.methods[0].method = method;
    plan.methods[0].modulation_hz = 200;
    plan.methods[0].dwell_s = dwell_s;
    return predict_heard_level(plan, {&cube, 1}).high_dba;
  };
  EXPECT_EQ(dba(touch::Method::single_focus, 1e-3), dba(touch::Method::single_focus, 2.5e-3));
  EXPECT_NE(dba(touch::Method::cross_section, 1e-3), dba(touch::Method::cross_section, 2.5e-3)) << "it moves";
}

TEST(EarLevel, CountsSeveralFociWithEqualAmplitudesIfThePlanCanPlayThem) {
  StudyPlan plan = plan_on("openmpd");
  const EarLevel& usual = full_level();
  EXPECT_EQ(usual.foci.size(), 1u) << "normalised, single foci are the loudest";
  EXPECT_FALSE(usual.full_amplitude);
  const auto unnamed_in = [](StudyPlan names) {
    for (PlanMethod& method : names.methods) {
      method.amplitude.reset();
      method.solver.reset();
      method.constraint.reset();
    }
    return names;
  };
  const StudyPlan as_usual = unnamed_in(plan);
  const EarLevel unnamed = level_of(as_usual);
  EXPECT_TRUE(unnamed.full_amplitude) << "palpa's own defaults";
  plan = as_usual;
  plan.shapes[1].asks_pressure = true;
  const EarLevel asking = level_of(plan);
  EXPECT_EQ(unnamed.predicted_db(), asking.predicted_db());
  EXPECT_TRUE(asking.full_amplitude);
  EXPECT_GT(asking.foci.size(), 1u);
  EXPECT_NEAR(usual.predicted_db(), 136.7 + untried_db, 0.1);
  EXPECT_NEAR(asking.predicted_db(), 140.3 + untried_equal_db, 0.1);
  EXPECT_NEAR(asking.bound_db, usual.bound_db, 1e-9);
  EXPECT_GT(asking.bound_db, asking.predicted_db());
  // Boards without amplitudes: a quarter of the transducers sounds at full amplitude.
  StudyPlan on_off = unnamed_in(plan_on(test::on_off_board()));
  on_off.level.ears = plan.level.ears;
  const double full_db = level_of(on_off).predicted_db();
  EXPECT_NEAR(full_db, asking.predicted_db(), 0.5) << "the same places";
  on_off.level.ceiling = 0.25;
  const EarLevel quarter = level_of(on_off);
  EXPECT_NEAR(quarter.predicted_db(), full_db + 10 * std::log10(0.25), 1) << "beside the focus";
  EXPECT_NEAR(quarter.bound_db, asking.bound_db + 20 * std::log10(0.25), 0.2) << "in phase";
}

/// An object nearer to the ears is felt nearer to them, and the array's sound goes more towards them.
TEST(EarLevel, FollowsTheObjects) {
  StudyPlan plan = plan_on("openmpd");
  plan.level.ears = {Vec3(-0.08, 0.3, 0.65), Vec3(0.08, 0.3, 0.65)};
  const Vec3 way(0, 0.06, 0.06);
  const Box moved{cube.low + way, cube.high + way};
  const EarLevel own = level_of(plan), far = level_of(plan, moved);
  EXPECT_GT(far.predicted_db(), own.predicted_db() + 2);
  ASSERT_EQ(far.foci.size(), 1u);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_GE(far.foci[0][axis], moved.low[axis]);
    EXPECT_LE(far.foci[0][axis], moved.high[axis]);
  }
  EXPECT_GE(far.foci[0].y, moved.high.y - plan.run.deep_m);
  // One of several objects is enough, whatever its place in the plan. What is within another one adds nothing.
  std::vector<Box> objects(plan.shapes.size(), cube);
  objects[2] = moved;
  EXPECT_EQ(predict_ear_level(plan, objects).db, far.db);
  objects[2] = {cube.low / 2.0, cube.high / 2.0};
  EXPECT_EQ(predict_ear_level(plan, objects).db, own.db);
}

/// 104.5 dB with the second step, sin(2 pi / 128), are 110.51 dB with the fourth.
TEST(EarLevel, AReadingReplacesThePrediction) {
  StudyPlan plan = plan_on("openmpd", 0.1);
  plan.shapes[0].asks_pressure = true;
  plan.level.measured_db = 104.5;
  plan.level.measured_ceiling = 0.05;
  const EarLevel level = level_of(plan);
  EXPECT_NEAR(level.loudest_db(), 110.5103, 1e-3);
  EXPECT_NEAR(level.equivalent_db(), 110.5103 + 10 * std::log10(1260 / 28800.0), 1e-3);
  EXPECT_ERROR(refuse_loud(plan, level, ""), Exit::usage, "110.5 dB are measured at an ear");
  plan.level.ceiling = level.fitting_ceiling;
  refuse_loud(plan, level_of(plan), "");
  plan.level.ceiling = 0.0979;  // the third step
  const EarLevel third = level_of(plan);
  EXPECT_NEAR(third.loudest_db(),
              104.5 + 20 * std::log10(std::sin(3 * std::numbers::pi / 128) / std::sin(2 * std::numbers::pi / 128)),
              1e-3);
  refuse_loud(plan, third, "");
  plan.shapes[0].asks_pressure = false;
  // A plan that nobody can hear is silent, whatever was read.
  plan.level.ceiling = 0;
  EXPECT_LT(level_of(plan).loudest_db(), -20);
  plan.level.ceiling = 0.04;
  // Reflections explain 10 dB. What is 20 dB too low is another sound, such as what a meter for speech hears.
  const double predicted_db = level_of(plan_on("openmpd", 0.05)).predicted_db();
  const auto reads = [&](double below_db) {
    plan.level.measured_db = predicted_db - below_db;
    return level_of(plan);
  };
  EXPECT_EQ(doubt_of_reading(plan, reads(9.9)), "");
  const std::string doubt = doubt_of_reading(plan, reads(10.1));
  const double own_db = level_of(plan_on("openmpd", 0.04)).predicted_db();
  EXPECT_CONTAINS(doubt, fmt::format("measured_db means {:.1f} dB at the plan's ceiling, but {:.1f} dB are predicted",
                                     own_db - 10.1, own_db));
  EXPECT_CONTAINS(doubt, "does not hear 40 kHz");
  refuse_loud(plan, reads(19.9), "");
  const EarLevel low = reads(20.1);
  EXPECT_ERROR(refuse_loud(plan, low, ""), Exit::usage, "measured_db is 20 dB below the prediction");
  refuse_loud(plan, low, "ethics 12/2026");
  // Boards without amplitudes get quieter by less.
  StudyPlan on_off = plan_on(test::on_off_board(), 0.025);
  on_off.level.measured_db = 98;
  on_off.level.measured_ceiling = 0.1;
  EXPECT_NEAR(level_of(on_off).loudest_db(), 98 - 6, 1.5);
  on_off.level.ceiling = 0.2;
  EXPECT_NEAR(level_of(on_off).loudest_db(), 98 + 3, 1.6);
}

TEST(EarLevel, ThePapersArrayIsFarTooLoudAtFullAmplitude) {
  StudyPlan plan = plan_on("paper");
  plan.level.ears = {Vec3(0, 0, 0.65), Vec3(0.02, 0, 0.65)};
  EXPECT_NEAR(level_of(plan).db[0], 133, 5) << "half a metre before its opening";
  const StudyPlan as_it_is = read_plan(test::source_file("assets/studies/paper.toml"));
  const EarLevel level = level_of(as_it_is);
  EXPECT_LE(level.loudest_db(), as_it_is.level.limit_db);
  refuse_loud(as_it_is, level, "");
}

TEST(EarLevel, AboveTheLimitNeedsAnApprovalOrACeilingThatIsNamed) {
  StudyPlan plan = plan_on("openmpd", 0.04);
  EarLevel level;
  level.db = {plan.level.limit_db + 10, plan.level.limit_db};
  level.fitting_ceiling = 0.012;
  const std::string usual = test::error_of([&] { refuse_loud(plan, level, ""); }, Exit::usage);
  EXPECT_CONTAINS(usual, "lower the ceiling of its [level] from 0.04 to 0.012, or move");
  EXPECT_EQ(usual.find("millimetres"), std::string::npos);
  refuse_loud(plan, level, "ethics 12/2026");
  EXPECT_ERROR(refuse_loud(plan, level, " \t"), Exit::usage, "--override is blank");
  level.db[0] = plan.level.limit_db + 41;
  level.fitting_ceiling = 0.00035;
  EXPECT_ERROR(refuse_loud(plan, level, ""), Exit::usage, "from 0.04 to 0.00035, or move");
  EXPECT_ERROR(refuse_loud(plan, level, ""), Exit::usage, "are in millimetres");
  level.fitting_ceiling = 0;
  EXPECT_ERROR(refuse_loud(plan, level, ""), Exit::usage, "no ceiling at which the array sounds is quiet enough");
}

TEST(EarLevel, TheCeilingThatIsNamedFits) {
  for (const std::string& layout : {std::string("openmpd"), test::on_off_board()}) {
    const StudyPlan loud = plan_on(layout, 0.5);
    const EarLevel level = level_of(loud);
    ASSERT_GT(level.predicted_db(), loud.level.limit_db);
    if (level.fitting_ceiling == 0) continue;
    const EarLevel fits = level_of(plan_on(layout, level.fitting_ceiling));
    EXPECT_LE(fits.predicted_db(), loud.level.limit_db) << layout;
    EXPECT_GT(fits.predicted_db(), loud.level.limit_db - 12) << layout;
    EXPECT_EQ(fits.fitting_ceiling, 0);
  }
}

TEST(EarLevel, APlanWhoseBoardsWouldBeSilentIsRefused) {
  StudyPlan plan = plan_on("openmpd", 0.0246);
  refuse_silent(plan);
  plan.shapes[1].intensity = 0.5;
  EXPECT_ERROR(refuse_silent(plan), Exit::usage,
               "times the intensity 0.5 of '" + plan.shapes[1].name + "' is 0.0123, below 0.0246");
  plan.shapes[1].intensity = 1;
  plan.level.ceiling = 0.0244;
  EXPECT_ERROR(refuse_silent(plan), Exit::usage,
               "the ceiling of [level] is 0.0244, below 0.0246, the least amplitude that the OpenMPD boards");
  plan.level.ceiling = 0.04;
  plan.level.measured_ceiling = 0.02;
  refuse_silent(plan);
  plan.level.measured_db = 100;
  EXPECT_ERROR(refuse_silent(plan), Exit::usage, "measured_ceiling of [level] is 0.02");
  plan.level.measured_db.reset();
  plan.shapes[2].pressure_pa = 10;  // one transducer is louder than that, at this ceiling
  EXPECT_ERROR(refuse_silent(plan), Exit::usage,
               "the ceiling 0.04 times the amplitude for the 10 Pa of '" + plan.shapes[2].name + "'");
  plan.shapes[2].pressure_pa = 1e5;
  refuse_silent(plan);
  array::Layout factored = array::load_layout("openmpd");
  factored.factors.assign(factored.transducers.size(), 0.5f);
  EXPECT_ERROR(refuse_silent(plan, &factored), Exit::usage,
               "is 0.04, below 0.0491, the least amplitude that the OpenMPD boards of openmpd play with the factors");
  plan.shapes[2].intensity = 0.01;
  plan.shapes[2].is_spring = true;
  EXPECT_ERROR(refuse_silent(plan), Exit::usage, "times the intensity at its stiffest 0.01 of");
  plan = plan_on(test::on_off_board(), 0.0039);
  EXPECT_ERROR(refuse_silent(plan), Exit::usage,
               "the least amplitude that the " + std::string(test::on_off_type().title) + " boards");
  refuse_silent(plan_on(test::on_off_board(), 1.0 / 256));
}

}  // namespace
}  // namespace palpa::study
