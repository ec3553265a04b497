// Each method's schedule for the same touch, frame by frame.
#include <gtest/gtest.h>

#include "geometry/gltf/gltf.hpp"
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

  Frame() {
    std::vector<glm::vec3> points;
    for (const Vec3& p : palpa::test::finger_skin().mesh.positions)
      points.emplace_back(p.x, p.y - 3e-3, p.z);
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
