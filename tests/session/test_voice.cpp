// Voices from fingers: the foci that play, their order and their modulation.
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "session/plan/voice.hpp"
#include "touch/methods/method.hpp"

namespace palpa::session {
namespace {

using array::fill_order;
using array::Schedule;
using array::SlotFocus;
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

TEST(Voice, KeepsAFingersFoci) {
  const Voice voice = voice_of(finger_with({5, 5, 5, 5, 5, 5, 5, 5, 5, 5}));
  EXPECT_EQ(places(voice), (std::vector<double>{0, 1, 2, 3, 4, 5, 6, 7, 8, 9}));
  EXPECT_EQ(voice.order, fill_order(10, 3));
  EXPECT_EQ(voice.id, 7u);
  EXPECT_EQ(voice.solid, 5u);
  EXPECT_EQ(voice.modulation_hz, 0);
  EXPECT_EQ(voice.foci_per_slot, 1u);
  EXPECT_EQ(voice.dwell_s, 1.5e-3);
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

TEST(Voice, TogetherThereIsNoOrderToFill) {
  VoiceOptions options;
  options.stride = 5;  // not coprime
  const Voice voice = voice_of(finger_with(std::vector<std::uint32_t>(10, 1)), options, touch::Method::multi_focus);
  EXPECT_EQ(voice.order, (std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5, 6, 7, 8, 9}));
  EXPECT_EQ(voice.foci_per_slot, 10u);
}

TEST(Voice, TogetherLeavesEmptySectorsOut) {
  const Voice voice = voice_of(finger_with({0, 1, 1, 0, 1}), {}, touch::Method::multi_focus);
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

}  // namespace
}  // namespace palpa::session
