// The line in which `palpa run` shows its state on a terminal.
#include <gtest/gtest.h>

#include <string>

#include "cli/run_line.hpp"
#include "support/thrown.hpp"

namespace palpa::test {
namespace {

using cli::run_line;
using cli::RunState;

TEST(RunLine, SaysWhatHappens) {
  RunState state{.link = "openmpd:A", .frames = 45, .rate_hz = 89.8, .latency_s = 4.24e-3, .fingers = 2};
  state.depth_m = 1.42e-3;
  state.sounds = true;
  EXPECT_EQ(run_line(state, 100),
            "SOUNDING on openmpd:A | 2 fingers, 1.4 mm deep | 90 frames/s, 4.2 ms | Ctrl-C stops");
  state.sounds = false;
  state.fingers = 1;
  state.of = 90;
  EXPECT_EQ(run_line(state, 100),
            "silent on openmpd:A | 1 finger, 1.4 mm deep | 45 of 90 frames, 90/s, 4.2 ms | Ctrl-C stops");
  state.stuck = true;
  EXPECT_CONTAINS(run_line(state, 140), "MAY SOUND on openmpd:A, which takes no drives | 1 finger");
  state.stuck = false;
  state.fingers = 0;
  state.rate_hz = 0;
  state.of = 0;
  state.link = "null";
  EXPECT_EQ(run_line(state, 100), "silent on null (no array) | no touch | no frames now | Ctrl-C stops");
  state.to_be_recorded = 3;
  EXPECT_EQ(run_line(state, 100), "silent | writing the recording: 3 frames left | Ctrl-C stops");
}

TEST(RunLine, FitsIntoTheTerminal) {
  RunState usual{.link = "null", .frames = 45, .rate_hz = 89.8, .latency_s = 4.24e-3, .fingers = 1};
  usual.depth_m = 1.42e-3;
  usual.sounds = true;
  EXPECT_EQ(run_line(usual, 100),
            "SOUNDING on null (no array) | 1 finger, 1.4 mm deep | 90 frames/s, 4.2 ms | Ctrl-C stops");
  EXPECT_EQ(run_line(usual, 79), "SOUNDING on null | 1 finger, 1.4 mm deep | 90 frames/s, 4.2 ms | Ctrl-C stops");
  RunState board{.link = "openmpd:EMU1", .frames = 45, .of = 300, .rate_hz = 89.8, .latency_s = 4.24e-3, .fingers = 2};
  board.depth_m = 1.42e-3;
  board.sounds = true;
  EXPECT_EQ(run_line(board, 85), "SOUNDING on openmpd:EMU1 | 2 fingers, 1.4 mm | 45/300, 90/s, 4.2 ms | Ctrl-C stops");
  EXPECT_EQ(run_line(board, 70), "SOUNDING | 2 fingers, 1.4 mm | 45/300, 90/s, 4.2 ms | Ctrl-C stops");
  RunState state{.link = std::string(300, 'x') + "\x1b[2J", .frames = 1, .rate_hz = 90, .fingers = 64};
  state.of = 1'000'000;
  EXPECT_EQ(run_line(state, 20).size(), 20u);
  EXPECT_EQ(run_line(state, 0), "");
  EXPECT_EQ(run_line(state, 300).find('\x1b'), std::string::npos);
}

}  // namespace
}  // namespace palpa::test
