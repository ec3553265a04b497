// How many drives reached which point: a guard's report to its loop.
#include <gtest/gtest.h>

#include <csignal>
#include <cstdint>
#include <mutex>
#include <string>

#include "driver/guard/guard.hpp"
#include "guard_rig.hpp"

namespace palpa::test {
namespace {

TEST(GuardCounts, ItsCountsComeBackThroughTheSharedMemory) {
  GuardRig rig;
  rig.open();
  const auto carried = [&] { return rig.link->carried().value(); };
  EXPECT_EQ(carried().guard->drives, 0u);
  rig.plan(0, 10);
  for (std::uint64_t s = 0; s < 5; ++s) {
    rig.send(s);
    ASSERT_TRUE(rig.wrote("play " + std::to_string(s)));
  }
  rig.link->finish();
  for (const session::Passed& passed : {*carried().guard, carried().submitted, carried().completed}) {
    EXPECT_EQ(passed.drives, 5u);
    EXPECT_EQ(passed.plans, 1u);
  }
  EXPECT_EQ(rig.link->carried()->guard->drives, 5u) << "they outlive the guard";
}

TEST(GuardCounts, DrivesThatItDoesNotTakeInTimeAreMissingInItsCounts) {
  GuardRig rig;
  rig.open();
  rig.send(0);
  ASSERT_TRUE(rig.wrote("play 0"));
  kill(guard_of_ours(), SIGSTOP);
  for (std::uint64_t s = 1; s <= 20; ++s)
    rig.send(s);
  kill(guard_of_ours(), SIGCONT);
  ASSERT_TRUE(rig.wrote("play 20"));
  rig.link->finish();
  EXPECT_EQ(rig.link->carried()->guard->drives, 2u) << "the first and the newest";
  EXPECT_EQ(rig.link->carried()->completed.drives, 2u);
}

TEST(GuardCounts, SilenceIsNotCounted) {
  GuardRig rig;
  rig.open();
  const array::Drive silent(rig.drive.size(), {0.0f, 1.0f});
  for (std::uint64_t s = 0; s < 3; ++s) {
    rig.link->send(s, silent);
    ASSERT_TRUE(rig.wrote("play " + std::to_string(s)));
  }
  rig.link->finish();
  EXPECT_EQ(rig.link->carried()->guard->drives, 0u);
}

TEST(GuardTime, ADriveThatNobodyFollowsUpEndsWithItsPlan) {
  using driver::is_overdue;
  constexpr double captured_s = 50, hold_s = 0.1, until_s = captured_s + hold_s, slot_s = 1.5e-3;
  // A loop that hangs at any time before the hold is over: silence comes at most 20 ms after the hold, and not before
  // its end.
  for (int ms = 0; ms < 100; ++ms) {
    const double heard_s = captured_s + 1e-3 * ms;
    EXPECT_TRUE(is_overdue(until_s + 0.010, heard_s, until_s, slot_s)) << ms;
    EXPECT_EQ(is_overdue(until_s - 1e-6, heard_s, until_s, slot_s), ms == 0 && driver::heartbeat_s < hold_s) << ms;
  }
  EXPECT_FALSE(is_overdue(until_s + 0.5, until_s + 0.495, until_s, slot_s)) << "a ramp goes on after the hold";
  EXPECT_TRUE(is_overdue(until_s + 0.5, until_s + 0.489, until_s, slot_s)) << "unless it stops";
  EXPECT_FALSE(is_overdue(until_s + 0.5, until_s + 0.48, until_s, 0.02)) << "slots of 20 ms";
  EXPECT_FALSE(is_overdue(52, 51.95, 60, slot_s)) << "a long hold";
  EXPECT_TRUE(is_overdue(52.051, 51.95, 60, slot_s)) << "of which no more than the heartbeat is waited for";
}

TEST(GuardTime, ItsLoopTellsItHowLongAPlanMaySound) {
  GuardRig rig;
  rig.open();
  rig.plan(0, 10);
  rig.send(0);
  ASSERT_TRUE(rig.wrote("play 0"));
  ASSERT_TRUE(rig.ends_with("off")) << "nobody follows it up";
  rig.plan(100, 10);
  rig.send(100);
  EXPECT_TRUE(rig.wrote("play 100"));
  rig.link->finish();
  rig.expect_silent_end();
}

}  // namespace
}  // namespace palpa::test
