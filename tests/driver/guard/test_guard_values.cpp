// What a loop and its guard compute, without processes: when a board is silenced, and what they tell each other.
#include <gtest/gtest.h>

#include <cstddef>
#include <span>
#include <vector>

#include "base/error.hpp"
#include "driver/guard/brief.hpp"
#include "driver/guard/channel.hpp"
#include "driver/guard/guard.hpp"
#include "driver/guard/patience.hpp"
#include "support/thrown.hpp"

namespace palpa::driver {
namespace {

TEST(GuardTime, ADriveThatNobodyFollowsUpEndsWithItsPlan) {
  constexpr double captured_s = 50, hold_s = 0.1, until_s = captured_s + hold_s, slot_s = 1.5e-3;
  // A loop that hangs at any time before the hold is over: silence comes at most 20 ms after the hold, and not before
  // its end.
  for (int ms = 0; ms < 100; ++ms) {
    const double heard_s = captured_s + 1e-3 * ms;
    EXPECT_TRUE(is_overdue(until_s + 0.010, heard_s, until_s, slot_s)) << ms;
    EXPECT_EQ(is_overdue(until_s - 1e-6, heard_s, until_s, slot_s), ms == 0 && heartbeat_s < hold_s) << ms;
  }
  EXPECT_FALSE(is_overdue(until_s + 0.5, until_s + 0.495, until_s, slot_s)) << "a ramp goes on after the hold";
  EXPECT_TRUE(is_overdue(until_s + 0.5, until_s + 0.489, until_s, slot_s)) << "unless it stops";
  EXPECT_FALSE(is_overdue(until_s + 0.5, until_s + 0.48, until_s, 0.02)) << "slots of 20 ms";
  EXPECT_FALSE(is_overdue(52, 51.95, 60, slot_s)) << "a long hold";
  EXPECT_TRUE(is_overdue(52.051, 51.95, 60, slot_s)) << "of which no more than the heartbeat is waited for";
}

TEST(GuardTime, ShortStallsDoNotAddUpAndOneOfASecondEndsIt) {
  constexpr double slot_s = 1.5e-3, long_s = 40e-3;
  double now_s = 70;
  Patience patience(slot_s, now_s);
  // How many drives end it, if it takes none; 0: not even `most`.
  const auto drives_until_it_ends = [&](double step_s, int most) {
    for (int i = 1; i <= most; ++i) {
      if (patience.ends(true, now_s += step_s)) return i;
    }
    return 0;
  };
  for (int stall = 0; stall < 20; ++stall) {
    EXPECT_EQ(drives_until_it_ends(slot_s, 600), 0) << "0.9 s";
    EXPECT_FALSE(patience.ends(false, now_s += slot_s)) << stall;
  }
  EXPECT_NEAR(drives_until_it_ends(slot_s, 2000), 1 / slot_s, 1);
  patience.ends(false, now_s += 5);
  EXPECT_NEAR(drives_until_it_ends(5, 2000), 0.5 / slot_s, 1) << "a loop that was stopped for 5 s each time";
  Patience with_long_slots(long_s, now_s);
  EXPECT_FALSE(with_long_slots.ends(true, now_s + 5));
}

TEST(GuardPlan, EndsWhereItsLastSlotDoes) {
  EXPECT_DOUBLE_EQ((TimedSlots{{.from = 10, .until = 14}, 100, 1.5e-3}).until_s(), 100.006);
  EXPECT_EQ((TimedSlots{{.from = 14, .until = 10}, 100, 1.5e-3}).until_s(), 100) << "it came too late";
}

TEST(GuardBrief, ComesOverWhole) {
  Brief brief{"openmpd", {"A,B", "some folder", {}, 2e-3, false, 340, 0.01, true, true}, true};
  array::Layout& layout = brief.board.layout;
  layout.name = "mine";
  layout.transducers = {{Vec3(1, 2, 3), Vec3(0, 0, 1)}, {Vec3(-1, 0.5, 1e-9), Vec3(1, 0, 0)}};
  layout.boards = {{"openmpd", 0, 2, 0.1, 0.2, Transform(2.0)}};
  layout.source_level_pa_m = 3;
  const std::vector<std::byte> bytes = to_bytes(brief);
  const Brief back = brief_from(bytes);
  EXPECT_EQ(to_bytes(back), bytes);
  EXPECT_EQ(back.board.argument, "A,B");
  EXPECT_EQ(back.board.layout.transducers[1].position, Vec3(-1, 0.5, 1e-9));
  EXPECT_EQ(back.board.layout.boards[0].T_layout_board, Transform(2.0));
  EXPECT_TRUE(back.only_silence);
  EXPECT_FALSE(back.board.foci_move);
  EXPECT_EQ(back.board.ramp_s, 0.01);
  EXPECT_TRUE(back.board.steps);
  EXPECT_TRUE(back.board.nulls);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    const std::span<const std::byte> cut(bytes.data(), size);
    EXPECT_ERROR(brief_from(cut), Exit::failed, "another version");
  }
}

}  // namespace
}  // namespace palpa::driver
