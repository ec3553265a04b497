// How many drives reached which point: the counts of boards and their guard.
#include <gtest/gtest.h>

#include <cstdint>
#include <mutex>
#include <string>

#include "driver/autd3/autd3_rig.hpp"
#include "driver/board.hpp"
#include "driver/sonicsurface/sonicsurface_rig.hpp"
#include "support/pseudo_terminal.hpp"

namespace palpa::test {
namespace {

TEST(Autd3Counts, CountsDrivesAsThePlanThatTheyBelongToHasCome) {
  Autd3Rig rig;
  rig.open();
  const auto counts = [&] { return rig.board->counts(); };
  const auto play = [&](int drives) {
    for (int i = 0; i < drives; ++i, ++rig.slot)
      rig.board->play(rig.slot, rig.part(rig.slot));
  };
  {
    // A server that hangs: the data that may wait until a plan arrives is bounded, and later data is lost.
    const std::lock_guard hangs(rig.serving->lock);
    rig.plan();
    play(10);
    EXPECT_EQ(counts().starting, 10u);
    play(20);
    EXPECT_EQ(counts().starting, 18u) << "13 messages of 2 ms";
    EXPECT_EQ(counts().completed.drives, 0u);
  }
  ASSERT_TRUE(rig.tend_until([&] { return counts().completed.plans == 1; }));
  EXPECT_EQ(counts().submitted.plans, 1u);
  play(40);
  EXPECT_EQ(counts().completed.drives, 40u);
  EXPECT_EQ(counts().submitted.drives, 40u);
  EXPECT_EQ(counts().starting, 18u);
  rig.board->all_off();
  EXPECT_TRUE(rig.board->close());
}

TEST(Autd3Counts, CountsDrivesThatComeOneByOne) {
  Autd3Rig rig;
  rig.open();
  {
    const std::lock_guard hangs(rig.serving->lock);
    for (std::uint64_t s = 1; s < 30; ++s)
      rig.board->play(s, rig.part(s));
    EXPECT_EQ(rig.board->counts().submitted.drives, 1u) << "each waits for the one before";
    EXPECT_EQ(rig.board->counts().completed.drives, 0u);
  }
  EXPECT_TRUE(rig.tend_until([&] { return part_heard(rig, 0) == 9; }));
  EXPECT_TRUE(rig.tend_until([&] { return rig.board->counts().completed.drives == 2; })) << "the first and the newest";
  EXPECT_EQ(rig.board->counts().submitted.drives, 2u);
  rig.board->all_off();
  EXPECT_TRUE(rig.board->close());
}

TEST(SonicSurfaceCounts, CountsWhatItPlays) {
  PALPA_TERMINAL_OR_SKIP();
  SonicSurfaceRig rig;
  rig.board = rig.make(1.5e-3, false);
  const auto counts = [&] { return rig.board->counts(); };
  rig.plan(200);
  std::uint64_t slot = 100;
  EXPECT_TRUE(rig.tend_until([&] {
    rig.board->play(slot++, rig.drive);
    return counts().completed.plans == 1;
  }));
  const driver::BoardCounts begun = counts();
  EXPECT_EQ(begun.submitted.plans, 1u);
  EXPECT_GT(begun.starting, 0u) << "nothing is heard before both buffers were silenced and the frame is there";
  for (int i = 0; i < 50; ++i)
    rig.board->play(slot++, rig.drive);
  EXPECT_EQ(counts().completed.drives, begun.completed.drives + 50);
  EXPECT_EQ(counts().starting, begun.starting);
  rig.board->all_off();
  rig.expect_silent_end();
}

TEST(SonicSurfaceCounts, CountsTheDrivesThatReplaceEachOther) {
  PALPA_TERMINAL_OR_SKIP();
  SonicSurfaceRig rig;
  rig.board = rig.make(12e-3, true);
  for (std::uint64_t s = 0; s < 20; ++s)
    rig.board->play(s, rig.drive);
  EXPECT_TRUE(rig.tend_until([&] { return rig.board->counts().completed.drives > 0; }));
  EXPECT_TRUE(rig.tend_until([&] { return rig.plays(rig.drive); }));
  EXPECT_LE(rig.board->counts().submitted.drives, 2u) << "of twenty the newest, and one on its way before";
  EXPECT_EQ(rig.board->counts().completed.drives, rig.board->counts().submitted.drives);
  rig.board->all_off();
  rig.expect_silent_end();
}

}  // namespace
}  // namespace palpa::test
