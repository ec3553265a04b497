// The emulated OpenMPD board has the same pitfalls as the real one.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include "driver/openmpd/emulated/board.hpp"
#include "driver/openmpd/emulated/fpga.hpp"
#include "driver/openmpd/frame.hpp"
#include "driver/openmpd/openmpd_files.hpp"
#include "driver/usb/ftdi.hpp"

namespace palpa::test {
namespace {

namespace openmpd = driver::openmpd;
namespace ftdi = driver::usb::ftdi;
using driver::usb::Outcome;

/// A whole frame of `phase` at full amplitude.
openmpd::Frame plain_frame(std::uint8_t phase) {
  openmpd::Frame frame;
  std::fill_n(frame.begin(), 256, phase);
  std::fill_n(frame.begin() + 256, 256, 64);
  frame[0] |= 0x80;
  return frame;
}

struct Board {
  driver::emulate::Violations violations;
  openmpd::Fpga fpga{violations};
  double now_s = 3;

  Board() { fpga.advance(now_s); }
  void give(std::span<const std::uint8_t> bytes) { ASSERT_EQ(fpga.take(now_s, bytes), bytes.size()); }
  void pass(double seconds) { fpga.advance(now_s += seconds); }
  void resynchronise() {
    fpga.begin_resync(now_s);
    pass(1.1);
    give(openmpd::all_off_frame);
    pass(1e-3);
  }
};

TEST(OpenMpdFpga, IsSilentFromASecondAfterPowerUpAndReadsNothingBefore) {
  driver::emulate::Violations violations;
  openmpd::Fpga fpga(violations);
  EXPECT_EQ(fpga.take(0.1, plain_frame(5)), 512u);
  fpga.advance(0.99);
  EXPECT_EQ(fpga.frames(), 0u);
  EXPECT_EQ(fpga.buffered(), 512u);
  std::vector<bool> silent;
  fpga.on_shown([&](double, const openmpd::Pulses& pulses) { silent.push_back(pulses[7].width == 0); });
  fpga.advance(1.01);
  EXPECT_EQ(silent, (std::vector<bool>{true, false}));
}

TEST(OpenMpdFpga, TakesAFrameEveryDividerPeriodsFromThePeriodsEdgeOn) {
  Board board;
  std::vector<double> shown;
  board.fpga.on_shown([&](double time_s, const openmpd::Pulses&) { shown.push_back(time_s - 3); });
  for (std::uint8_t i = 0; i < 5; ++i)
    board.give(plain_frame(i));
  board.pass(1e-3);
  ASSERT_EQ(shown.size(), 5u);
  EXPECT_NEAR(shown[0], 25e-6, 1e-9);
  for (std::size_t i = 1; i < shown.size(); ++i)
    EXPECT_NEAR(shown[i] - shown[i - 1], 100e-6, 1e-9);
  EXPECT_TRUE(board.fpga.sounds()) << "what came last sounds on";
  board.pass(10);
  EXPECT_TRUE(board.fpga.sounds());
}

TEST(OpenMpdFpga, TheDividerPersistsAndNoneIs256) {
  Board board;
  board.give(openmpd::with_divider(openmpd::all_off_frame, 40));
  board.pass(0.01);
  EXPECT_EQ(board.fpga.divider(), 40u);
  board.give(openmpd::all_off_frame);
  EXPECT_EQ(board.fpga.divider(), 40u);
  board.give(openmpd::with_divider(openmpd::all_off_frame, 0));
  board.pass(0.01);
  EXPECT_EQ(board.fpga.divider(), 256u);
  EXPECT_EQ(board.fpga.dividers_set(), 2u);
}

TEST(OpenMpdFpga, ClearsWhatIsNoWholeFrameAfterASecond) {
  Board board;
  board.resynchronise();
  const openmpd::Frame frame = plain_frame(1);
  board.give(std::span(frame).first(511));
  board.pass(0.9);
  EXPECT_EQ(board.fpga.buffered(), 511u);
  board.pass(0.2);
  EXPECT_EQ(board.fpga.buffered(), 0u);
  EXPECT_EQ(board.fpga.clears(), 1u);
  EXPECT_EQ(board.violations.count(), 1u) << "nobody cuts a frame on purpose";
}

TEST(OpenMpdFpga, OneLostByteLosesEveryOtherFrame) {
  Board board;
  board.resynchronise();
  std::vector<unsigned> shown;
  board.fpga.on_shown([&](double, const openmpd::Pulses& pulses) { shown.push_back(pulses[200].phase); });
  const openmpd::Frame cut = plain_frame(1);
  board.give(std::span(cut).first(511));
  for (std::uint8_t i = 2; i < 12; ++i) {
    board.give(plain_frame(i));
    board.pass(1.5e-3);
  }
  ASSERT_GE(shown.size(), 4u);
  EXPECT_EQ(shown[0], 1u);
  for (std::size_t i = 1; i + 1 < shown.size(); ++i)
    EXPECT_EQ(shown[i + 1] - shown[i], 2u) << "every other frame is lost";
  EXPECT_GE(board.violations.count(), 4u);
}

TEST(OpenMpdFpga, ZerosFlushTheParserFromEveryState) {
  for (std::size_t state = 0; state < 512; ++state) {
    Board board;
    // This many bytes of a frame that stops there: filled up to blocks with zeros before it.
    std::vector<std::uint8_t> bytes(512 - state, 0);
    const openmpd::Frame frame = plain_frame(3);
    bytes.insert(bytes.end(), frame.begin(), frame.begin() + static_cast<std::ptrdiff_t>(state));
    board.give(bytes);
    board.give(std::vector<std::uint8_t>(512, 0));
    board.give(openmpd::all_off_frame);
    board.pass(1e-3);
    const std::uint64_t before = board.fpga.frames();
    ASSERT_FALSE(board.fpga.sounds()) << state;
    board.give(plain_frame(9));
    board.pass(1e-3);
    ASSERT_EQ(board.fpga.frames(), before + 1) << state;
    ASSERT_EQ(board.fpga.pulses()[255], (openmpd::Pulse{9, 64})) << state;
  }
}

TEST(OpenMpdFpga, OnlyWhatWasLeftInItsBufferSoundsDuringAResynchronisation) {
  Board board;
  board.resynchronise();
  for (int i = 0; i < 5; ++i)
    board.give(plain_frame(7));
  board.fpga.begin_resync(board.now_s);
  ASSERT_GE(board.fpga.buffered(), 4 * 512u);
  board.pass(1e-2);
  EXPECT_TRUE(board.fpga.sounds());
  EXPECT_EQ(board.violations.count(), 0u);
  for (int i = 0; i < 2; ++i)
    board.give(plain_frame(7));
  board.pass(1e-2);
  ASSERT_EQ(board.violations.count(), 1u);
  EXPECT_EQ(board.violations.kept()[0].what, "sound before the board was resynchronised");
}

TEST(OpenMpdFpga, ReportsFaultsThatARealBoardWouldAccept) {
  const auto fault_of = [](const openmpd::Frame& frame) {
    Board board;
    board.resynchronise();
    board.give(frame);
    return board.violations.count() == 0 ? "" : board.violations.kept()[0].what;
  };
  EXPECT_EQ(fault_of(plain_frame(0)), "");
  for (const auto& [at, what] : {std::pair<std::size_t, const char*>{1, "a frame sets a light"},
                                 {24, "a frame sets a light"},
                                 {25, "a frame switches lights"},
                                 {26, "a frame has bits of the divider but does not set it"},
                                 {33, "a frame has bits of the divider but does not set it"},
                                 {35, "a phase of more than 127"},
                                 {255, "a phase of more than 127"},
                                 {256, "an amplitude with bit 7"}}) {
    openmpd::Frame frame = plain_frame(0);
    frame[at] |= 0x80;
    EXPECT_EQ(fault_of(frame), what) << at;
  }
  openmpd::Frame wide = plain_frame(0);
  wide[300] = 65;
  EXPECT_EQ(fault_of(wide), "a pulse longer than half a period");
  openmpd::Frame late = plain_frame(0);
  late[0] = 5;
  EXPECT_EQ(fault_of(late), "a byte that belongs to no frame: frames are out of step");
}

TEST(OpenMpdChip, WantsItsRequestsInOrderAndDropsBytesBeforeThePurge) {
  openmpd::EmulatedBoard board("S");
  std::size_t filled = 0;
  const auto ask = [&](const driver::usb::Setup& setup) { return board.control(3, setup, {}, filled); };
  EXPECT_EQ(board.identity().vendor, 0x0403);
  EXPECT_EQ(board.identity().product, 0x6014);
  EXPECT_EQ(board.identity().release, 0x0900);
  std::array<std::uint8_t, 2> word{};
  EXPECT_EQ(board.control(3, {0xc0, 0x90, 0, 0}, word, filled), Outcome::done);
  EXPECT_EQ(word[0] & 0xf, 1);
  EXPECT_EQ(ask({0x40, 0, 0, 0}), Outcome::done);
  EXPECT_EQ(board.bulk_out(3, 2, plain_frame(1)), 512u);
  EXPECT_EQ(board.violations().count(), 1u);
  EXPECT_EQ(board.fpga().buffered(), 0u);
  EXPECT_EQ(ask({0x40, 9, 2, 0}), Outcome::done);  // the latency, before the bit mode
  EXPECT_EQ(board.violations().count(), 2u);
  EXPECT_EQ(ask({0x40, 3, 0x4138, 0}), Outcome::stalled);  // a baud rate
  EXPECT_EQ(board.violations().count(), 3u);

  for (const auto& setup : ftdi::ready_requests)
    EXPECT_EQ(ask(setup), Outcome::done);
  EXPECT_EQ(board.violations().count(), 3u);
  EXPECT_EQ(board.bulk_out(3, 2, plain_frame(1)), 512u);
  board.advance(3.001);
  EXPECT_TRUE(board.fpga().sounds());
  board.closed(3.002);
  board.advance(3.2);
  ASSERT_EQ(board.violations().count(), 4u);
  EXPECT_EQ(board.violations().kept()[3].what, "left sounding by the program that had it open");
}

TEST(OpenMpdChip, TakesAKibibyteMoreThanTheBoardDoes) {
  openmpd::EmulatedBoard board("S");
  std::size_t filled = 0;
  for (const auto& setup : ftdi::ready_requests)
    board.control(3, setup, {}, filled);
  const std::vector<std::uint8_t> zeros(20000, 0);
  // The first block leaves at once, and one is read every 0.1 ms.
  EXPECT_EQ(board.bulk_out(3, 2, zeros), 512u + 14336 + 1024);
  EXPECT_EQ(board.bulk_out(3.00011, 2, zeros), 512u);
}

}  // namespace
}  // namespace palpa::test
