// How boards go from drive to drive, by their records.
#include "array/layouts/changes.hpp"

#include <gtest/gtest.h>

#include <string>
#include <string_view>

#include "array/layouts/board_types.hpp"
#include "support/thrown.hpp"

namespace palpa::array {
namespace {

const BoardType* const autd3 = find_board_type("autd3");
const BoardType* const openmpd = find_board_type("openmpd");
const BoardType* const sonicsurface = find_board_type("sonicsurface");

Layout boards_of(std::string_view type, std::size_t count) {
  Layout layout;
  layout.boards.resize(count);
  for (Board& board : layout.boards)
    board.type = type;
  return layout;
}

TEST(Changes, OpenMpdTakesTheStepsThatItsBusCarries) {
  // 40 MB/s and 512 bytes a frame: 117 frames in 1.5 ms.
  for (const auto& [boards, steps] : {std::pair(1, 14), {8, 14}, {9, 13}, {12, 9}, {16, 7}, {58, 2}, {59, 1}}) {
    const Changes changes = changes_of(openmpd, {.boards_of_bus = static_cast<std::size_t>(boards)});
    EXPECT_EQ(changes.phase_steps, static_cast<std::uint32_t>(steps)) << boards;
    EXPECT_EQ(changes.amplitude_steps, changes.phase_steps);
    EXPECT_EQ(changes.step_periods, 4u);
    EXPECT_TRUE(changes.silence_jumps);
  }
  EXPECT_EQ(changes_of(openmpd, {.slot_s = 0.3e-3}).phase_steps, 2u);
  EXPECT_EQ(changes_of(openmpd, {.slot_s = 0.25e-3}).phase_steps, 1u);
  EXPECT_EQ(changes_of(openmpd, {.slot_s = 50e-3}).phase_steps, 14u);
  EXPECT_EQ(changes_of(openmpd, {.steps = false}).phase_steps, 1u);
  EXPECT_EQ(changes_of(openmpd, {.nulls = true}).phase_steps, 1u);
}

TEST(Changes, Autd3TakesTheSlotWithOrWithoutSteps) {
  for (const bool steps : {false, true}) {
    const Changes changes = changes_of(autd3, {.steps = steps});
    EXPECT_EQ(changes.phase_steps, 60u);
    EXPECT_EQ(changes.amplitude_steps, 10u);
    EXPECT_EQ(changes.step_periods, 1u);
    EXPECT_FALSE(changes.silence_jumps);
  }
  EXPECT_EQ(changes_of(autd3, {.slot_s = 20e-3}).phase_steps, 255u);
  EXPECT_EQ(changes_of(autd3, {.slot_s = 0.1e-3}).amplitude_steps, 4u);
  EXPECT_EQ(changes_of(autd3, {.nulls = true}).phase_steps, 1u);
}

TEST(Changes, OthersJump) {
  EXPECT_EQ(changes_of(sonicsurface, {}).phase_steps, 1u);
  EXPECT_EQ(changes_of(nullptr, {}).phase_steps, 1u);
  EXPECT_EQ(why_fewer_steps(sonicsurface, {.nulls = true}), "");
  EXPECT_EQ(why_fewer_steps(nullptr, {.nulls = true}), "");
}

TEST(Changes, SayWhyTheyHaveFewerSteps) {
  EXPECT_EQ(why_fewer_steps(openmpd, {}), "");
  EXPECT_EQ(why_fewer_steps(openmpd, {.boards_of_bus = 8}), "");
  EXPECT_EQ(why_fewer_steps(openmpd, {.boards_of_bus = 9}),
            "phases change in the first 1.3 ms of a dwell of 1.5 ms, because the USB bus carries no more steps");
  EXPECT_EQ(why_fewer_steps(openmpd, {.slot_s = 3e-3}),
            "phases change in the first 1.4 ms of a dwell of 3 ms, because silence must not wait longer");
  EXPECT_EQ(
      why_fewer_steps(openmpd, {.slot_s = 0.25e-3}),
      "phases jump from drive to drive, because a dwell of 0.25 ms has no room for steps; --steps off avoids this "
      "warning");
  EXPECT_EQ(why_fewer_steps(openmpd, {.slot_s = 0.3e-3, .boards_of_bus = 12}),
            "phases jump from drive to drive, because the USB bus carries one frame for each drive; --steps off avoids "
            "this warning");
  EXPECT_EQ(why_fewer_steps(openmpd, {.slot_s = 0.25e-3, .steps = false, .nulls = true}), "");
  for (const BoardType* const type : {autd3, openmpd})
    EXPECT_CONTAINS(why_fewer_steps(type, {.nulls = true}), "with nulls, phases jump from drive to drive, because");
  EXPECT_EQ(why_fewer_steps(autd3, {.slot_s = 0.1e-3, .boards_of_bus = 99}), "");
}

TEST(Changes, FociThatStandStillHaveShortSlotsWhereTheBusCarriesTheirSteps) {
  for (const std::size_t boards : {1UL, 2UL, 11UL})
    EXPECT_EQ(still_slot_s(boards_of("openmpd", boards)), 0.3e-3) << boards;
  EXPECT_EQ(still_slot_s(boards_of("openmpd", 12)), 0);
  for (const BoardType& type : board_types())
    EXPECT_EQ(still_slot_s(boards_of(type.name, 1)), &type == openmpd ? 0.3e-3 : 0) << type.name;
  EXPECT_EQ(still_slot_s(boards_of("another", 1)), 0);
  EXPECT_EQ(still_slot_s({}), 0);
  for (const double hz : {15.75, 200.0, 1000.0})
    EXPECT_EQ(autd3->modulation_slot_s(hz), 0.25e-3) << hz;
  EXPECT_DOUBLE_EQ(autd3->modulation_slot_s(10), 0.4e-3) << "250 samples of a cycle";
  EXPECT_DOUBLE_EQ(autd3->modulation_slot_s(5), 0.8e-3);
  EXPECT_DOUBLE_EQ(autd3->modulation_slot_s(1), 4e-3);
}

}  // namespace
}  // namespace palpa::array
