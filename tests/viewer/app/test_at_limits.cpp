// Exactly at the limits of what the viewer shows and lets through.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>

#include "viewer/live/frame_gaps.hpp"
#include "viewer/panel_data/messages.hpp"
#include "viewer/study/gate.hpp"

namespace palpa::viewer {
namespace {

TEST(AtLimits, FourMessagesAreShownForSixSeconds) {
  Messages messages;
  for (int n = 0; n < 4; ++n)
    messages.say(log::Level::warning, std::to_string(n));
  EXPECT_EQ(messages.toasts().size(), 4U);
  messages.say(log::Level::warning, "4");
  ASSERT_EQ(messages.toasts().size(), 4U);
  EXPECT_EQ(messages.toasts().front().text, "1");
  messages.advance(std::nextafter(6.0, 0), {});
  EXPECT_EQ(messages.toasts().size(), 4U);
  messages.advance(6, {});
  EXPECT_TRUE(messages.toasts().empty());
}

TEST(AtLimits, TheLogKeepsAsManyLinesAsTheTail) {
  Messages messages;
  for (std::size_t n = 0; n < log::Tail::most; ++n)
    messages.advance(0, {{log::Level::info, std::to_string(n)}});
  EXPECT_EQ(messages.log().front().text, "0");
  messages.advance(0, {{log::Level::info, "next"}});
  EXPECT_EQ(messages.log().size(), log::Tail::most);
  EXPECT_EQ(messages.log().front().text, "1");
}

TEST(AtLimits, AFrameIsWaitedForLessThanAQuarterOfASecond) {
  Rhythm rhythm;
  rhythm.arrived(0, 1);
  EXPECT_EQ(rhythm.wait_until(std::nextafter(1.25, 0), 1e-3), 1.25);
  EXPECT_FALSE(rhythm.wait_until(1.25, 1e-3));
  for (const double second_s : {1.25, std::nextafter(1.25, 2)}) {
    Rhythm slow;
    slow.arrived(0, 1);
    slow.planned(0, 1);
    slow.arrived(1, second_s);
    slow.planned(1, second_s);
    EXPECT_EQ(slow.wait_until(1.499, 2e-3).has_value(), second_s == 1.25) << "a rhythm of four frames a second";
  }
}

TEST(AtLimits, FewerThan99PercentOfTheDrivesAreTooFew) {
  for (const std::uint64_t sounding : {0U, 99U, 100U, 1000U}) {
    const std::uint64_t may_be_lost = GateCounts::overtaken + sounding / 100;
    const std::uint64_t all = sounding;
    for (std::uint64_t lost = 0; lost <= std::min(all, may_be_lost + 1); ++lost) {
      const GateCounts counts{.sounding = all, .arrived = all - lost};
      EXPECT_EQ(counts.too_few(), lost == may_be_lost + 1) << lost << " of " << all;
    }
  }
  EXPECT_FALSE((GateCounts{.sounding = 1000}).too_few()) << "a link that does not count";
}

TEST(AtLimits, AGateIsClosedAtItsMoment) {
  using namespace std::chrono_literals;
  const Gate::Clock::time_point until{1h};
  Gate gate;
  gate.open(until);
  EXPECT_TRUE(gate.is_open(until - 1ns));
  EXPECT_FALSE(gate.is_open(until));
}

}  // namespace
}  // namespace palpa::viewer
