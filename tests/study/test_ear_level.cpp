// The predicted level at a participant's ears.
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "acoustics/air.hpp"
#include "acoustics/field/pressure.hpp"
#include "base/error.hpp"
#include "study/plan/plan_file.hpp"
#include "study/sitting/ear_level.hpp"
#include "support/shared_data.hpp"

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

TEST(EarLevel, IsThatOfTheLoudestPlaceNearTheEar) {
  const StudyPlan plan = plan_on("openmpd");
  const EarLevel level = predict_ear_level(plan);
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
  const EarLevel full = predict_ear_level(plan_on("openmpd")), tenth = predict_ear_level(plan_on("openmpd", 0.1));
  EXPECT_NEAR(full.loudest_db() - tenth.loudest_db(), 20, 1e-3);
  const StudyPlan plan = plan_on("openmpd");
  EXPECT_DOUBLE_EQ(full.sounding_s, sounding_s(plan));
  // Each method: 4 x 10 s, 180 s, 10 s, 40 x 10 s.
  EXPECT_DOUBLE_EQ(full.sounding_s, 2 * 630);
  EXPECT_NEAR(full.equivalent_db(), full.loudest_db() - 10 * std::log10(28800.0 / 1260), 1e-9);
}

TEST(EarLevel, ThePapersArrayIsFarTooLoudAtFullAmplitude) {
  StudyPlan plan = plan_on("paper");
  plan.level.ears = {Vec3(0, 0, 0.65), Vec3(0.02, 0, 0.65)};
  EXPECT_NEAR(predict_ear_level(plan).db[0], 133, 5) << "half a metre before its opening";
  const StudyPlan as_it_is = read_plan(test::source_file("assets/studies/paper.toml"));
  const EarLevel level = predict_ear_level(as_it_is);
  EXPECT_LE(level.loudest_db(), as_it_is.level.limit_db);
  refuse_loud(as_it_is, level, "");
}

TEST(EarLevel, AboveTheLimitSomebodySigns) {
  StudyPlan plan = plan_on("openmpd");
  plan.level.limit_db = 80;
  const EarLevel level = predict_ear_level(plan);
  try {
    refuse_loud(plan, level, "");
    ADD_FAILURE() << "not refused";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Exit::usage);
    EXPECT_NE(std::string(error.what()).find("lower the ceiling of its [level] from 1 to 0.0"), std::string::npos)
        << error.what();
  }
  refuse_loud(plan, level, "ethics 12/2026");
}

}  // namespace
}  // namespace palpa::study
