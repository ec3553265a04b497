// The haptics of solids, on their way into voices and slots.
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "session/plan/plan.hpp"
#include "session/plan/scheduler.hpp"
#include "session/plan/solid_haptics.hpp"
#include "support/thrown.hpp"

namespace palpa::session {
namespace {

std::vector<geometry::Solid> solids(const std::vector<geometry::Haptics>& haptics) {
  std::vector<geometry::Solid> made;
  for (const geometry::Haptics& own : haptics) {
    geometry::Solid solid;
    solid.name = "solid " + std::to_string(made.size());
    solid.haptics = own;
    made.push_back(solid);
  }
  return made;
}

TEST(Haptics, TakeThePlaceOfWhatHoldsForAll) {
  geometry::Haptics own;
  own.dwell_s = 1e-3;
  own.intensity = 0.25;
  const auto made = solids({{}, own});
  const array::VoiceOptions all{.stride = 3, .dwell_s = 1.5e-3};
  const auto resolved = resolve_haptics("scene.glb", made, {}, all);
  const array::VoiceOptions &a = resolved[0].voice, &b = resolved[1].voice;
  EXPECT_EQ(a.stride, 3U);
  EXPECT_EQ(a.dwell_s, 1.5e-3);
  EXPECT_EQ(a.gain, 1);
  EXPECT_EQ(b.stride, 3U);
  EXPECT_EQ(b.dwell_s, 1e-3);
  EXPECT_EQ(b.gain, 0.25);
  EXPECT_EQ(resolved[1].foci, 10U);
  EXPECT_FALSE(resolved[0].own_schedule);
  EXPECT_TRUE(resolved[1].own_schedule);
  geometry::Haptics quiet;
  quiet.intensity = 0.5;
  EXPECT_FALSE(resolve_haptics("scene.glb", solids({quiet}), {}, all)[0].own_schedule)
      << "intensity is no part of the schedule";
}

TEST(Haptics, ASlotDividesEveryDwell) {
  const auto with = [](std::vector<double> dwells) {
    std::vector<geometry::Haptics> haptics;
    for (const double dwell : dwells) {
      haptics.emplace_back();
      if (dwell > 0) haptics.back().dwell_s = dwell;
    }
    const array::VoiceOptions all{.dwell_s = 1.5e-3};
    return slot_length(resolve_haptics("scene.glb", solids(haptics), {}, all), all);
  };
  EXPECT_EQ(with({}), 1.5e-3);
  EXPECT_EQ(with({0}), 1.5e-3);
  EXPECT_EQ(with({0, 3e-3}), 1.5e-3);
  EXPECT_DOUBLE_EQ(with({0, 1e-3}), 0.5e-3);
  EXPECT_DOUBLE_EQ(with({0, 2e-3, 1.25e-3}), 0.25e-3);
  EXPECT_DOUBLE_EQ(with({0, 1.1e-3}), 1.1e-3) << "0.1 ms would be too short: the shorter of the two";
  EXPECT_DOUBLE_EQ(with({1e-4}), 1e-4) << "a dwell that all share is the slot";
}

TEST(Haptics, AStrideThatLeavesFociOutIsTheFilesFault) {
  geometry::Haptics nine, five;
  nine.foci = 9;
  five.stride = 5;
  const touch::Parameters parameters;
  array::VoiceOptions voice{.stride = 3};
  const auto fault = [&](const std::vector<geometry::Haptics>& haptics) -> std::string {
    try {
      resolve_haptics("scene.glb", solids(haptics), parameters, voice);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), Exit::bad_input);
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(fault({{}, {}}), "");
  EXPECT_EQ(
      fault({{}, nine}),
      "scene.glb: node 'solid 1': stride 3 and 9 foci share the divisor 3, so some foci would never sound; give a "
      "stride such as 2");
  EXPECT_NE(fault({five}).find("stride 5 and 10 foci share the divisor 5"), std::string::npos);
  EXPECT_NE(fault({five}).find("such as 3"), std::string::npos);
  five.foci = 7;
  EXPECT_EQ(fault({five}), "");
  geometry::Haptics one;
  one.foci = 1;
  one.stride = 6;
  EXPECT_EQ(fault({one}), "") << "one focus has one order";
  voice.stride.reset();
  EXPECT_EQ(fault({{}, nine}), "") << "no solid and no option asks for a stride";
  EXPECT_EQ(resolve_haptics("scene.glb", solids({{}, nine}), parameters, voice)[0].voice.stride, 3U);
  EXPECT_EQ(resolve_haptics("scene.glb", solids({{}, nine}), parameters, voice)[1].voice.stride, 2U);
  // Options that apply to all solids are not the scene's fault.
  EXPECT_ERROR(resolve_haptics("scene.glb", {}, parameters, {.stride = 5}), Exit::usage, "stride 5 and 10 foci");
}

/// A finger whose focus n stands at x = n millimetres, y = its solid.
touch::Finger finger(std::uint32_t id, std::uint32_t solid, std::uint32_t foci) {
  touch::Finger made;
  made.id = id;
  made.solid = solid;
  for (std::uint32_t n = 0; n < foci; ++n)
    made.foci.push_back({{1e-3F * static_cast<float>(n), static_cast<float>(solid), 0}, 7});
  return made;
}

TEST(Haptics, EveryFingerPlaysAsItsSolidAsks) {
  geometry::Haptics own;
  own.foci = 4;
  own.stride = 1;
  own.dwell_s = 3e-3;
  own.intensity = 0.5;
  const auto made = solids({{}, own});
  touch::Touch touch;
  touch.fingers = {finger(8, 1, 4), finger(9, 0, 10)};
  touch.finger_count = 2;
  array::Schedule schedule;
  Scheduler("scene.glb", made, {}, {}).make(touch, 1.0, schedule);
  ASSERT_EQ(schedule.voice_count, 2U);
  EXPECT_EQ(schedule.slot_s, 1.5e-3);
  EXPECT_EQ(schedule.voices[0].id, 8U);
  std::vector<array::SlotFocus> foci;
  // By hand: finger 8 goes 0, 0, 1, 1, 2, 2, ... of four foci; finger 9 every third of ten, one per slot.
  const int slow[] = {0, 0, 1, 1, 2, 2, 3, 3, 0, 0, 1, 1}, fast[] = {0, 3, 6, 9, 2, 5, 8, 1, 4, 7, 0, 3};
  for (std::uint64_t slot = 0; slot < 12; ++slot) {
    array::foci_of_slot(schedule, slot, foci);
    ASSERT_EQ(foci.size(), 2U);
    EXPECT_NEAR(foci[0].position.x, 1e-3 * slow[slot], 1e-9) << slot;
    EXPECT_NEAR(foci[1].position.x, 1e-3 * fast[slot], 1e-9) << slot;
    EXPECT_EQ(foci[0].gain, 0.5F);
    EXPECT_EQ(foci[1].gain, 1.0F);
  }
  // 8 slots and 10 slots repeat together after 40; all of them go into a plan.
  Plan plan;
  plan.schedule = schedule;
  SlotWork work;
  std::size_t slots = 0;
  plan_slots(plan, work, nullptr, [&](std::span<const array::SlotFocus> both, const auto&) {
    ++slots;
    EXPECT_EQ(both[0].gain, 0.5F);
  });
  EXPECT_EQ(plan.cycle.length, 40U);
  EXPECT_EQ(slots, 40U);
}

TEST(Haptics, ATextureTakesThePlaceOfTheModulation) {
  geometry::Haptics smooth;
  smooth.texture = {1, 0, 0};
  const auto made = solids({smooth, {}});
  touch::Touch touch;
  touch.fingers = {finger(8, 0, 1), finger(9, 1, 1)};  // foci that stand still
  touch.finger_count = 2;
  array::Schedule schedule;
  for (const bool steady : {false, true}) {
    Scheduler scheduler("scene.glb", made, {}, {.steady = steady});
    scheduler.make(touch, 1.0, schedule, {.follows = true});
    EXPECT_EQ(schedule.voices[0].modulation_hz, steady ? 200 : 0) << "a link that is too slow plays no texture";
    EXPECT_EQ(schedule.voices[1].modulation_hz, 200);
    scheduler.change_feel(1, {.texture = array::Texture{0, 0, 1}});
    scheduler.make(touch, 1.01, schedule, {.follows = true});
    EXPECT_EQ(schedule.voices[1].modulation_hz, steady ? 200 : 0);
  }
}

}  // namespace
}  // namespace palpa::session
