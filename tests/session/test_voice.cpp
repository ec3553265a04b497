// Voices from fingers: the foci that play, their order and their modulation, also where a solid has its own haptics.
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "fakes.hpp"
#include "session/plan/scheduler.hpp"
#include "session/plan/solid_haptics.hpp"
#include "session/plan/voice.hpp"
#include "support/thrown.hpp"
#include "touch/methods/method.hpp"

namespace palpa::session {
namespace {

using array::Schedule;
using array::Voice;
using array::VoiceOptions;

/// A finger whose sector n lies at x = n. Sectors with 0 points are at NaN, because nothing may use them.
touch::Finger finger_with(const std::vector<std::uint32_t>& points) {
  touch::Finger finger;
  for (std::size_t n = 0; n < points.size(); ++n) {
    const float x = points[n] ? static_cast<float>(n) : std::nanf("");
    finger.foci.push_back({{x, 0, 0}, points[n]});
  }
  finger.section.centroid = {-1, 0, 0};
  return finger;
}

touch::Placement placed(const touch::Finger& finger, touch::Method method = touch::Method::cross_section) {
  touch::Placement placement;
  touch::place_foci({}, finger, {.method = method}, placement);
  return placement;
}

Voice voice_of(const touch::Finger& finger, const VoiceOptions& options = {},
               touch::Method method = touch::Method::cross_section) {
  Voice voice;
  make_voice(placed(finger, method), 7, 5, options, voice);
  return voice;
}

std::vector<double> places(const Voice& voice) {
  std::vector<double> xs;
  for (const Vec3& focus : voice.foci)
    xs.push_back(focus.x);
  return xs;
}

TEST(Voice, NearestOtherAgreesWithAngles) {
  EXPECT_TRUE(rc::check([] {
    const auto points =
        *rc::gen::suchThat(rc::gen::container<std::vector<std::uint32_t>>(rc::gen::inRange<std::uint32_t>(0, 2)),
                           [](const auto& p) { return p.size() <= 64 && std::ranges::count(p, 1u) > 0; });
    VoiceOptions options;
    options.stride = 1;
    const auto played = places(voice_of(finger_with(points), options));
    const double turn = 2 * std::numbers::pi / static_cast<double>(points.size());
    for (std::size_t n = 0; n < points.size(); ++n) {
      double best = 10;
      double chosen = -1;
      for (std::size_t other = 0; other < points.size(); ++other) {
        if (points[other] == 0) continue;
        const double a = turn * static_cast<double>(n), b = turn * static_cast<double>(other);
        const double apart = std::acos(std::clamp(std::cos(a) * std::cos(b) + std::sin(a) * std::sin(b), -1.0, 1.0));
        if (apart < best - 1e-6) best = apart, chosen = static_cast<double>(other);
      }
      RC_ASSERT(played[n] == chosen);
    }
  }));
}

TEST(Voice, PointLikeFingersAreModulated) {
  touch::Finger finger = finger_with({2});
  finger.point_like = true;
  const Voice voice = voice_of(finger);
  EXPECT_EQ(places(voice), std::vector<double>{-1}) << "the centroid";
  EXPECT_EQ(voice.order, std::vector<std::uint32_t>{0});
  EXPECT_EQ(voice.modulation_hz, 200);
}

TEST(Voice, WithoutAnyFocusThereIsTheCentroid) {
  EXPECT_EQ(places(voice_of(finger_with({0, 0, 0}))), std::vector<double>{-1});
  EXPECT_EQ(places(voice_of(finger_with({}))), std::vector<double>{-1});
}

TEST(Voice, TogetherThereIsNoOrderToFillAndEmptySectorsAreLeftOut) {
  const VoiceOptions not_coprime{.stride = 3};
  const Voice voice = voice_of(finger_with({0, 1, 1, 0, 1}), not_coprime, touch::Method::multi_focus);
  EXPECT_EQ(places(voice), (std::vector<double>{1, 2, 4}));
  EXPECT_EQ(voice.order, (std::vector<std::uint32_t>{0, 1, 2}));
  EXPECT_EQ(voice.foci_per_slot, 3u);
  EXPECT_EQ(voice.modulation_hz, 200) << "nothing moves";
}

TEST(ByFinger, VoicesAreMatchedByTheirIds) {
  Schedule plan;
  for (const std::uint32_t id : {7u, 3u}) {
    Voice& voice = plan.add_voice();
    voice = voice_of(finger_with({1, 1, 1}));
    voice.id = id;
  }
  plan.add_voice().id = 5;
  plan.voice_count = 2;  // the third is one of an earlier frame
  touch::Touch seen;
  seen.fingers.resize(4);
  for (std::uint32_t f = 0; const std::uint32_t id : {5u, 3u, 7u, 9u})
    seen.fingers[f++].id = id;
  seen.finger_count = 3;
  const Schedule schedule = by_finger(plan, seen);
  ASSERT_EQ(schedule.voice_count, 3U);
  EXPECT_TRUE(schedule.voices[0].foci.empty()) << "of a finger that is expected to have left";
  EXPECT_EQ(schedule.voices[1].id, 3U);
  EXPECT_EQ(schedule.voices[2].id, 7U);
  EXPECT_EQ(schedule.voices[2].foci.size(), 3U);
}

TEST(Haptics, ThatSetFociStrideOrDwellAreAnOwnSchedule) {
  std::vector<geometry::Haptics> haptics(5);
  haptics[1].dwell_s = 1e-3;
  haptics[2].foci = 7;
  haptics[3].stride = 3;
  haptics[4].intensity = 0.5;
  const auto resolved = resolve_haptics("scene.glb", test::solids_with(haptics), {}, {.stride = 3, .dwell_s = 1.5e-3});
  for (std::size_t s = 0; s < haptics.size(); ++s)
    EXPECT_EQ(resolved[s].own_schedule, s >= 1 && s <= 3) << s;
}

TEST(Haptics, ASlotDividesEveryDwell) {
  const auto with = [](std::vector<double> dwells) {
    std::vector<geometry::Haptics> haptics;
    for (const double dwell : dwells) {
      haptics.emplace_back();
      if (dwell > 0) haptics.back().dwell_s = dwell;
    }
    const array::VoiceOptions all{.dwell_s = 1.5e-3};
    return slot_length(resolve_haptics("scene.glb", test::solids_with(haptics), {}, all), all);
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
  const touch::FingerOptions parameters;
  array::VoiceOptions voice{.stride = 3};
  const auto fault = [&](const std::vector<geometry::Haptics>& haptics) {
    return test::error_of([&] { resolve_haptics("scene.glb", test::solids_with(haptics), parameters, voice); });
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
  EXPECT_EQ(resolve_haptics("scene.glb", test::solids_with({{}, nine}), parameters, voice)[0].voice.stride, 3U);
  EXPECT_EQ(resolve_haptics("scene.glb", test::solids_with({{}, nine}), parameters, voice)[1].voice.stride, 2U);
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
  touch::Touch touch;
  touch.fingers = {finger(8, 1, 4), finger(9, 0, 10)};
  touch.finger_count = 2;
  array::Schedule schedule;
  Scheduler("scene.glb", test::solids_with({{}, own}), {}, {}).make(touch, 1.0, schedule);
  ASSERT_EQ(schedule.voice_count, 2U);
  EXPECT_EQ(schedule.slot_s, 1.5e-3);
  const array::Voice &asked = schedule.voices[0], &usual = schedule.voices[1];
  EXPECT_EQ(asked.id, 8U);
  EXPECT_EQ(asked.solid, 1U);
  EXPECT_EQ(asked.order, (std::vector<std::uint32_t>{0, 1, 2, 3}));
  EXPECT_EQ(asked.dwell_s, 3e-3);
  EXPECT_EQ(asked.gain, 0.5);
  EXPECT_EQ(usual.id, 9U);
  EXPECT_EQ(usual.order, (std::vector<std::uint32_t>{0, 3, 6, 9, 2, 5, 8, 1, 4, 7}));
  EXPECT_EQ(usual.dwell_s, 1.5e-3);
  EXPECT_EQ(usual.gain, 1.0);
  EXPECT_EQ(usual.solid, 0U);
  EXPECT_EQ(usual.foci_per_slot, 1U);
  EXPECT_EQ(usual.modulation_hz, 0) << "its foci move";
  for (std::uint32_t n = 0; n < 4; ++n)
    EXPECT_NEAR(asked.foci[n].x, 1e-3 * n, 1e-9);
}

TEST(Haptics, ATextureTakesThePlaceOfTheModulation) {
  geometry::Haptics smooth;
  smooth.texture = {1, 0, 0};
  const auto made = test::solids_with({smooth, {}});
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
