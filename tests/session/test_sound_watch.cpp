#include <gtest/gtest.h>

#include <chrono>
#include <optional>

#include "session/watch/sound_watch.hpp"

namespace palpa::session {
namespace {

using namespace std::chrono_literals;
constexpr SoundWatch::Clock::time_point begin{std::chrono::hours(1)};

/// A modulation has silent drives between those that sound, and no display may flicker.
TEST(SoundWatch, SoundsUntilNothingHasSoundedForAWhile) {
  SoundWatch watch;
  EXPECT_FALSE(watch.sounding(begin));
  watch.sent(false, std::nullopt, begin);
  EXPECT_FALSE(watch.sounding(begin));
  watch.sent(true, std::nullopt, begin);
  watch.sent(false, std::nullopt, begin + 2ms);
  EXPECT_TRUE(watch.sounding(begin + 60ms));
  EXPECT_FALSE(watch.sounding(begin + 140ms));
  watch.sent(true, std::nullopt, begin + 150ms);
  watch.close();
  EXPECT_FALSE(watch.sounding(begin + 150ms)) << "the run is over";
  EXPECT_FALSE(watch.stuck(begin + 150ms));
}

/// What sounds is what arrived, not what left.
TEST(SoundWatch, ABoardThatTakesNothingMaySound) {
  SoundWatch watch;
  Carried carried;
  const auto plays = [&](std::chrono::milliseconds from, std::chrono::milliseconds to, bool takes) {
    for (auto at = from; at < to; at += 2ms) {
      carried.completed.drives += takes ? 1 : 0;
      watch.sent(true, carried, begin + at);
    }
  };
  plays(0ms, 50ms, true);
  EXPECT_TRUE(watch.sounding(begin + 50ms));
  EXPECT_FALSE(watch.stuck(begin + 50ms));
  plays(50ms, 140ms, false);
  EXPECT_FALSE(watch.stuck(begin + 140ms)) << "drives may be under way";
  plays(140ms, 300ms, false);
  EXPECT_FALSE(watch.sounding(begin + 300ms));
  EXPECT_TRUE(watch.stuck(begin + 300ms));
  watch.sent(false, carried, begin + 450ms);
  EXPECT_FALSE(watch.stuck(begin + 450ms)) << "nothing is to sound";
  plays(455ms, 456ms, false);
  EXPECT_FALSE(watch.stuck(begin + 456ms)) << "this sound has only begun";
  plays(460ms, 470ms, true);
  EXPECT_TRUE(watch.sounding(begin + 470ms)) << "it is plugged in again";
  EXPECT_FALSE(watch.stuck(begin + 470ms));
  carried.out_of_reach = true;
  watch.sent(false, carried, begin + 480ms);
  EXPECT_TRUE(watch.stuck(begin + 10s)) << "it may still play what it has";
  carried.out_of_reach = false;
  watch.sent(false, carried, begin + 11s);
  EXPECT_FALSE(watch.stuck(begin + 11s));
  SoundWatch quiet;
  Carried none;
  none.out_of_reach = true;
  quiet.sent(false, none, begin);
  EXPECT_FALSE(quiet.stuck(begin)) << "nothing has sounded";
}

}  // namespace
}  // namespace palpa::session
