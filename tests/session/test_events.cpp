// Touches in, events out, against sequences that were worked out by hand.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>

#include "session/watch/events.hpp"

namespace palpa::session {
namespace {

struct Tip {
  std::uint32_t id = 0;
  std::uint32_t solid = 0;
  float x_m = 0;
  float depth_m = 0.001F;
};

touch::Touch touching(const std::vector<Tip>& tips) {
  touch::Touch touch;
  for (const Tip& tip : tips) {
    touch::Finger finger;
    finger.id = tip.id;
    finger.solid = tip.solid;
    finger.depth_m = tip.depth_m;
    finger.section.centroid = {tip.x_m, 0, 0};
    touch.fingers.push_back(finger);
  }
  touch.finger_count = static_cast<std::uint32_t>(tips.size());
  return touch;
}

std::vector<geometry::Solid> two_solids() {
  std::vector<geometry::Solid> solids(2);
  solids[0].name = "button";
  solids[0].haptics.press_depth_m = 0.003;
  solids[1].name = "knob";
  return solids;
}

/// "touch 0@button" and the like, in order.
std::string told(std::span<const Event> events) {
  std::string text;
  for (const Event& event : events) {
    text += std::string(text.empty() ? "" : ", ") + std::string(word_of(event_words, event.kind)) + ' ' +
            std::to_string(event.finger) + '@' + (event.solid == 0 ? "button" : "knob");
  }
  return text;
}

struct Events : ::testing::Test {
  std::vector<geometry::Solid> solids = two_solids();
  EventTracker tracker{solids};
  double time_s = 10;
  double step_s = 0.01;

  std::string frame(const std::vector<Tip>& tips) {
    time_s += step_s;
    return told(tracker.update(touching(tips), time_s));
  }
};

TEST_F(Events, OneTouchFromBeginningToEnd) {
  EXPECT_EQ(frame({}), "");
  EXPECT_EQ(frame({{7}}), "touch 7@button");
  EXPECT_EQ(frame({{7}}), "") << "it rests";
  EXPECT_EQ(frame({{7, 0, 0.0004F}}), "") << "less than half a millimetre";
  EXPECT_EQ(frame({{7, 0, 0.0006F}}), "move 7@button") << "in all more than that";
  EXPECT_EQ(frame({{7, 0, 0.0010F}}), "") << "counted from the last report";
  EXPECT_EQ(frame({}), "");
  time_s += 0.045;
  const auto events = tracker.update({}, time_s);
  ASSERT_EQ(told(events), "release 7@button");
  // Last seen at 10.06 s; the grace is 50 ms.
  EXPECT_NEAR(events[0].time_s, 10.11, 1e-12);
  EXPECT_FLOAT_EQ(events[0].centroid.x, 0.0010F);
  EXPECT_FLOAT_EQ(events[0].depth_m, 0.001F);
  EXPECT_EQ(told(tracker.end()), "");
}

TEST_F(Events, PressesOnceUntilTheFingerHasComeUpAgain) {
  EXPECT_EQ(frame({{0, 0, 0, 0.0010F}}), "touch 0@button");
  EXPECT_EQ(frame({{0, 0, 0, 0.0029F}}), "move 0@button");
  EXPECT_EQ(frame({{0, 0, 0, 0.0031F}}), "press 0@button");
  EXPECT_EQ(frame({{0, 0, 0, 0.0028F}}), "");
  EXPECT_EQ(frame({{0, 0, 0, 0.0032F}}), "") << "80 % of 3 mm are 2.4 mm: it has not come up";
  EXPECT_EQ(frame({{0, 0, 0, 0.0023F}}), "move 0@button");
  EXPECT_EQ(frame({{0, 0, 0, 0.0034F}}), "move 0@button, press 0@button");
}

TEST_F(Events, WithoutAPressDepthThereIsNoPress) {
  EXPECT_EQ(frame({{0, 1, 0, 0.001F}}), "touch 0@knob");
  EXPECT_EQ(frame({{0, 1, 0, 0.030F}}), "move 0@knob");
}

TEST_F(Events, AFingerThatComesBackContinuesItsTouch) {
  frame({{0, 0, 0.000F}, {1, 0, 0.030F}});
  EXPECT_EQ(frame({{1, 0, 0.030F}}), "");
  EXPECT_EQ(frame({{1, 0, 0.030F}, {0, 0, 0.024F}}), "move 0@button") << "wherever it comes back";
  const auto events = tracker.end();
  EXPECT_EQ(told(events), "release 0@button, release 1@button");
  EXPECT_EQ(events[0].time_s, time_s);
  EXPECT_EQ(told(tracker.end()), "");
}

TEST_F(Events, WhoIsWhoIsNotDecidedHere) {
  frame({{0, 0, 0.000F}});
  EXPECT_EQ(frame({{1, 0, 0.000F}}), "touch 1@button") << "another id, if in the same place";
  EXPECT_EQ(frame({{0, 0, 0.004F}, {1, 0, 0.000F}}), "move 0@button");
  frame({{1, 0, 0.000F}});
  step_s = 0.05;
  EXPECT_EQ(frame({{1, 0, 0.000F}}), "release 0@button");
}

TEST_F(Events, AFingerThatChangesItsSolidReleasesTheOldOne) {
  frame({{5, 0}});
  EXPECT_EQ(frame({{5, 1}}), "release 5@button, touch 5@knob");
  EXPECT_EQ(told(tracker.end()), "release 5@knob");
}

TEST_F(Events, FramesThatStopComingAreARelease) {
  frame({{0}});
  EXPECT_EQ(told(tracker.expire()), "release 0@button");
  EXPECT_EQ(frame({{0}}), "touch 0@button");
  // The same without a report: a gap in the frames' times longer than the hold of 100 ms.
  time_s += 0.2;
  const auto events = tracker.update(touching({{0}}), time_s);
  ASSERT_EQ(told(events), "release 0@button, touch 0@button");
  EXPECT_NEAR(events[0].time_s, 10.02 + 0.05, 1e-12);
  EXPECT_EQ(events[1].time_s, time_s);
}

TEST_F(Events, AClockThatIsSetBackFirstReleasesEachFingerThatTouches) {
  frame({{0}, {1, 1}});
  const double last_s = time_s;
  time_s = -1000;
  // A finger that is present all the time then has a new id.
  const auto events = tracker.update(touching({{2}}), time_s);
  ASSERT_EQ(told(events), "release 0@button, release 1@knob, touch 2@button");
  EXPECT_EQ(events[0].time_s, last_s);
  EXPECT_EQ(events[2].time_s, -1000);
  EXPECT_EQ(frame({{2}}), "");
  EXPECT_EQ(told(tracker.end()), "release 2@button");
}

TEST(EventTracker, EveryTouchHasOneReleaseAndTimesAscend) {
  std::mt19937 random(4);
  const std::vector<geometry::Solid> solids = two_solids();
  EventTracker tracker(solids);
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> open;
  double last_s = 0;
  std::size_t touches = 0, presses = 0;
  const auto check = [&](std::span<const Event> events) {
    for (const Event& event : events) {
      ASSERT_GE(event.time_s, last_s);
      last_s = event.time_s;
      int& count = open[{event.finger, event.solid}];
      if (event.kind == EventKind::touch) {
        ASSERT_EQ(count++, 0);
        ++touches;
      } else {
        ASSERT_EQ(count, 1) << word_of(event_words, event.kind);
        if (event.kind == EventKind::release) --count;
      }
      presses += event.kind == EventKind::press ? 1 : 0;
    }
  };
  double time_s = 0;
  for (int n = 0; n < 20'000; ++n) {
    time_s += random() % 50 == 0 ? 0.3 : 0.011;
    std::vector<Tip> tips;
    for (std::uint32_t id = 0; id < 6; ++id) {
      if (random() % 3 == 0) continue;
      tips.push_back({id + static_cast<std::uint32_t>(n / 7 * 6), static_cast<std::uint32_t>(random() % 20 == 0),
                      0.02F * static_cast<float>(id) + 1e-4F * static_cast<float>(random() % 100),
                      1e-5F * static_cast<float>(random() % 500)});
    }
    check(tracker.update(touching(tips), time_s));
    if (::testing::Test::HasFatalFailure()) return;
  }
  check(tracker.end());
  for (const auto& [key, count] : open)
    EXPECT_EQ(count, 0) << key.first;
  EXPECT_GT(touches, 1000U);
  EXPECT_GT(presses, 1000U);
}

TEST(EventTracker, ManyLostFingersUnderAClockThatStandsStillAreLetGo) {
  std::vector<geometry::Solid> solids(1);
  EventTracker tracker(solids);
  std::size_t releases = 0;
  for (std::uint32_t n = 0; n < 1000; ++n) {
    for (const Event& event : tracker.update(touching({{n, 0, static_cast<float>(n)}}), 1.0))
      releases += event.kind == EventKind::release ? 1 : 0;
  }
  EXPECT_GT(releases, 700U);
  EXPECT_EQ(releases + tracker.end().size(), 1000U);
}

TEST(EventLine, IsOneLineOfJson) {
  const std::vector<std::string> names{"button", "a \"knob\"\n"};
  JsonWriter json;
  write_event_line({EventKind::press, 1.25, 1, 3, 0.0035F, {0.01F, -0.5F, 0}}, names, json);
  EXPECT_EQ(json.finish(), R"({"event":"press","time_s":1.25,"solid":"a \"knob\"\u000a","finger":3,)"
                           R"("depth_m":0.0035,"centroid_m":[0.01,-0.5,0]})"
                           "\n");
}

}  // namespace
}  // namespace palpa::session
