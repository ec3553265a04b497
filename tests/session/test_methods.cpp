// Each method's schedule for the same touch, frame by frame.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>

#include "geometry/gltf/gltf.hpp"
#include "session/plan/plan.hpp"
#include "session/plan/scheduler.hpp"
#include "support/hand_skin.hpp"
#include "support/shared_data.hpp"
#include "touch/stage.hpp"

namespace palpa::session {
namespace {

using touch::Method;

struct Frame {
  std::vector<geometry::Solid> solids =
      geometry::make_solids(geometry::load_gltf(palpa::test::source_file("assets/cube.glb")));
  touch::Touch touch;

  explicit Frame(double depth_m = 3e-3) {
    std::vector<glm::vec3> points;
    for (const Vec3& p : palpa::test::finger_skin().mesh.positions)
      points.emplace_back(p.x, p.y - depth_m, p.z);
    touch::Stage(solids).touch(sensing::numbered(points), touch);
    for (touch::Finger& finger : touch.fingers)
      finger.id = 4;
  }
};

array::Schedule schedule_of(const Frame& frame, const ScheduleOptions& options) {
  Scheduler scheduler("cube.glb", frame.solids, {}, options);
  array::Schedule schedule;
  scheduler.make(frame.touch, 0, schedule);
  return schedule;
}

array::Schedule schedule_of(const Frame& frame, Method method) {
  return schedule_of(frame, {.method = {.method = method}});
}

TEST(Methods, EachMakesItsVoice) {
  const Frame frame;
  ASSERT_EQ(frame.touch.finger_count, 1u);
  const array::Schedule cross = schedule_of(frame, Method::cross_section);
  const array::Schedule ellipse = schedule_of(frame, Method::ellipse);
  const array::Schedule single = schedule_of(frame, Method::single_focus);
  const array::Schedule multi = schedule_of(frame, Method::multi_focus);
  for (const array::Schedule* schedule : {&cross, &ellipse, &single, &multi}) {
    ASSERT_EQ(schedule->voice_count, 1u);
    EXPECT_EQ(schedule->voices[0].id, 4u);
    EXPECT_EQ(schedule->voices[0].dwell_s, 1.5e-3);
  }
  EXPECT_EQ(cross.voices[0].order, array::fill_order(10, 3));
  EXPECT_EQ(ellipse.voices[0].order, array::fill_order(10, 3));
  EXPECT_EQ(single.voices[0].order, std::vector<std::uint32_t>{0});
  EXPECT_EQ(multi.voices[0].foci_per_slot, 10u);
  EXPECT_EQ(cross.voices[0].modulation_hz, 0);
  EXPECT_EQ(ellipse.voices[0].modulation_hz, 0);
  EXPECT_EQ(single.voices[0].modulation_hz, 200);
  EXPECT_EQ(multi.voices[0].modulation_hz, 200);
  // A finger in a flat face has an almost round ring of contacts: both methods place the foci at the same places.
  for (std::size_t n = 0; n < 10; ++n)
    EXPECT_LT(glm::distance(cross.voices[0].foci[n], ellipse.voices[0].foci[n]), 1e-3) << n;
  std::vector<array::SlotFocus> foci;
  array::foci_of_slot(multi, 5, foci);
  EXPECT_EQ(foci.size(), 10u);
}

TEST(Methods, AModulationIsOneGainOverTheWholePlan) {
  const Frame frame;
  for (const Method method : {Method::single_focus, Method::multi_focus}) {
    Plan plan;
    plan.schedule = schedule_of(frame, method);
    SlotWork work;
    std::size_t slots = 0;
    plan_slots(plan, work, nullptr, [&](const std::vector<array::SlotFocus>& slot, const auto&) {
      ++slots;
      EXPECT_EQ(slot[0].gain, 1.0F);
    });
    EXPECT_EQ(slots, 1u);
    EXPECT_EQ(plan.cycle.modulation_hz, 200);
    EXPECT_EQ(plan.cycle.modulation, array::Modulation::pressure_sine);
  }
}

TEST(Methods, TheModulationRunsOnFromFrameToFrame) {
  // Its time is that of the slot counter, not of the frame: two frames' schedules have the same gain in a slot.
  const Frame one(3e-3), two(2.5e-3);
  std::vector<array::SlotFocus> a, b;
  const array::Schedule first = schedule_of(one, Method::single_focus), second = schedule_of(two, Method::single_focus);
  for (std::uint64_t slot = 0; slot < 40; ++slot) {
    array::foci_of_slot(first, slot, a);
    array::foci_of_slot(second, slot, b);
    EXPECT_EQ(a.at(0).gain, b.at(0).gain);
    EXPECT_NE(a.at(0).position, b.at(0).position);
  }
}

TEST(Methods, TuningChangesTheStrideAlone) {
  const Frame frame;
  ScheduleOptions setting;
  setting.voice.stride = 1;
  setting.tune = Tune::stride;
  const array::Schedule tuned = schedule_of(frame, setting);
  // The cube's cross-section is about 30 mm around: 200 Hz is felt best.
  EXPECT_EQ(tuned.voices[0].order, array::fill_order(10, 3));
  EXPECT_EQ(tuned.voices[0].foci.size(), 10u);
  EXPECT_EQ(tuned.voices[0].dwell_s, 1.5e-3);
  // Nothing moves, so there is nothing to tune.
  setting.method.method = Method::multi_focus;
  EXPECT_EQ(schedule_of(frame, setting).voices[0].foci_per_slot, 10u);
  setting.tune = Tune::nothing;
  setting.method.method = Method::cross_section;
  EXPECT_EQ(schedule_of(frame, setting).voices[0].order, array::fill_order(10, 1));
}

}  // namespace
}  // namespace palpa::session
