// What a user is told about nulls.
#include "setup/options/nulls.hpp"

#include <gtest/gtest.h>

#include "array/layouts/layout.hpp"
#include "support/boards.hpp"
#include "support/thrown.hpp"

namespace palpa::test {
namespace {

using array::Constraint;
using setup::coarse_boards_line;

TEST(NullsOfBoards, AreDoubtedWhereAmplitudesAreCoarse) {
  const array::Layout on_off = array::load_layout(on_off_board()), mpd = array::load_layout("openmpd-pair");
  const std::string tty = on_off_board() + ":/dev/ttyUSB0";
  EXPECT_CONTAINS(coarse_boards_line(tty, on_off, Constraint::normalise, 1), "have no amplitudes");
  EXPECT_CONTAINS(coarse_boards_line(tty, on_off, Constraint::clamp, 0.5), "turns transducers off");
  EXPECT_EQ(coarse_boards_line(tty, on_off, Constraint::clamp, 1), "") << "full amplitudes, as uniform";
  EXPECT_CONTAINS(coarse_boards_line(tty, on_off, Constraint::uniform, 0.5),
                  "an intensity below 1 turns transducers off");
  EXPECT_EQ(coarse_boards_line(tty, on_off, Constraint::uniform, 1), "");
  EXPECT_CONTAINS(coarse_boards_line("openmpd:A:B", mpd, Constraint::normalise, 0.1),
                  "below 0.1 of the full amplitude");
  EXPECT_CONTAINS(coarse_boards_line("openmpd", mpd, Constraint::normalise, 0.04), "few amplitudes");
  EXPECT_EQ(coarse_boards_line("openmpd", mpd, Constraint::clamp, 0.04), "");
  EXPECT_EQ(coarse_boards_line("openmpd", mpd, Constraint::normalise, 0.3), "");
  EXPECT_EQ(coarse_boards_line("openmpd", mpd, Constraint::uniform, 0.04), "");
  // Not boards, or not those of the layout.
  EXPECT_EQ(coarse_boards_line("null", on_off, Constraint::normalise, 1), "");
  EXPECT_EQ(coarse_boards_line("record:drives", mpd, Constraint::normalise, 0.04), "");
  EXPECT_EQ(coarse_boards_line("autd3", array::load_layout("autd3"), Constraint::normalise, 0.04), "");
}

TEST(NullsInWords, LevelsAreBelowOrAbove) {
  EXPECT_EQ(setup::beside_weakest(-42.34, 1), "42.3 dB below the weakest focus");
  EXPECT_EQ(setup::beside_weakest(11.2, 0), "11 dB above the weakest focus");
}

}  // namespace
}  // namespace palpa::test
