// Faults of a board on a real kernel's USB. Each time, the program continues, reports it once, recovers by itself or
// ends, and the last thing that the board gets is silence.
#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "cli/support/process.hpp"
#include "support/begins.hpp"
#include "support/files.hpp"
#include "support/occurrences.hpp"
#include "support/thrown.hpp"
#include "usb/loop.hpp"
#include "usb/plugged_board.hpp"

namespace palpa::test {
namespace {

const std::vector<std::string> none;

/// Whether the board continues to play: transducers that it has not played before.
bool plays_on(PluggedBoard& board) {
  const std::size_t before = board.pins().size();
  return begins([&] { return board.pins().size() > before + 2; });
}

void expect_one_recovery(const Loop& loop, const std::string& trouble) {
  const std::string said = loop.said();
  EXPECT_EQ(occurrences(said, trouble), 1u) << said;
  EXPECT_EQ(occurrences(said, "in step again after"), 1u) << said;
  EXPECT_EQ(occurrences(said, "\n"), 2u) << said;
}

/// A board, and a loop that plays to it.
struct Sweep {
  Sweep() { EXPECT_TRUE(plays_on(board)) << loop.said(); }
  void expect_recovery(const std::string& trouble) {
    EXPECT_TRUE(plays_on(board)) << loop.said();
    EXPECT_EQ(loop.end(), 0);
    expect_one_recovery(loop, trouble);
    EXPECT_EQ(board.faults_at_the_end(), none);
  }

  PluggedBoard board{"EMU1"};
  Loop loop{"link", sweep_of("openmpd:EMU1")};
};

/// The process that holds the loop's board; 0 if there is none.
pid_t guard() {
  for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
    if (read_text(entry.path() / "comm") == "palpa-guard\n") return std::stoi(entry.path().filename().string());
  }
  return 0;
}

TEST(FaultsOnUsb, UnpluggedInTheMiddleOfAFrameAndPluggedInAgain) {
  Sweep sweep;
  sweep.board.gadget.unplug_after = 2 * 512 + 200;
  ASSERT_TRUE(begins([&] { return !sweep.board.port.plugged(); }));
  sweep.board.port.unplug();
  sweep.board.port.plug();
  sweep.expect_recovery("board EMU1: ");
}

TEST(FaultsOnUsb, OneOfTwoUnpluggedSilencesBoth) {
  PluggedBoard left("EMU1"), right("EMU2");
  Loop loop("link", sweep_of("openmpd:EMU1,EMU2", "openmpd-pair"));
  ASSERT_TRUE(plays_on(left)) << loop.said();
  right.port.unplug();
  EXPECT_TRUE(begins([&] { return !left.sounds(); }));
  EXPECT_FALSE(eventually(0.5, [&] { return left.sounds(); })) << "as long as the other is away";
  right.port.plug();
  EXPECT_TRUE(plays_on(left)) << loop.said();
  EXPECT_EQ(loop.end(), 0);
  expect_one_recovery(loop, "board EMU2: ");
  EXPECT_EQ(left.faults_at_the_end(), none);
  EXPECT_EQ(right.faults_at_the_end(), none);
}

TEST(FaultsOnUsb, AStalledEndpointIsClearedAndTheBoardPlaysOn) {
  Sweep sweep;
  sweep.board.gadget.stalls = true;
  sweep.expect_recovery("board EMU1: the device refuses it; it may still sound until it is in step again");
  EXPECT_FALSE(sweep.board.gadget.stalls) << "the halt is cleared";
}

TEST(FaultsOnUsb, ABoardThatTakesNoBytesForAWhilePlaysOn) {
  Sweep sweep;
  sweep.board.gadget.takes_nothing = true;
  EXPECT_TRUE(begins([&] { return !sweep.loop.said().empty(); }));
  sweep.board.gadget.takes_nothing = false;
  sweep.expect_recovery("board EMU1: it takes no bytes; it may still sound until it is in step again");
}

TEST(FaultsOnUsb, AKilledLoopLeavesSilence) {
  Sweep sweep;
  ASSERT_TRUE(begins([&] { return sweep.board.sounds(); }));
  sweep.loop.signal(SIGKILL);
  sweep.loop.wait();
  EXPECT_TRUE(begins([&] { return guard() == 0; })) << "the guard leaves";
  EXPECT_EQ(sweep.board.faults_at_the_end(), none);
}

TEST(FaultsOnUsb, AGuardThatIsKilledIsFollowedBySilence) {
  Sweep sweep;
  ASSERT_TRUE(begins([&] { return sweep.board.sounds(); }));
  ASSERT_NE(guard(), 0);
  kill(guard(), SIGKILL);
  EXPECT_EQ(sweep.loop.wait(), 1);
  const std::string said = sweep.loop.said();
  EXPECT_EQ(occurrences(said, "signal 9 ended palpa-guard, and a second one was started; the array ("), 1u) << said;
  EXPECT_EQ(guard(), 0);
  EXPECT_EQ(sweep.board.faults_at_the_end(), none);
}

TEST(FaultsOnUsb, ABoardInSerialModeIsRefused) {
  PluggedBoard board("EMU1", driver::usb::ftdi::Channel::uart);
  expect_failure(palpa(with({"link"}, sweep_of("openmpd:EMU1"))), 1, "its EEPROM says serial (UART)");
  EXPECT_EQ(board.gadget.bytes_taken, 0u);
  EXPECT_EQ(board.gadget.requests, 1u) << "it is asked what it is, and left alone";
}

/// Has the ids of a board's chip, and supports none of its requests.
class Stranger final : public driver::usb::Peripheral {
 public:
  const Identity& identity() const override { return identity_; }
  driver::usb::Outcome control(double, const driver::usb::Setup&, std::span<std::uint8_t>, std::size_t&) override {
    return driver::usb::Outcome::stalled;
  }
  std::size_t bulk_out(double, std::uint8_t, std::span<const std::uint8_t> bytes) override { return bytes.size(); }
  void advance(double) override {}
  void closed(double) override {}
  void unplugged(double) override {}

 private:
  Identity identity_{driver::usb::ftdi::vendor, driver::usb::ftdi::product_232h, 0x0700, "EMU1"};
};

TEST(FaultsOnUsb, SomethingElseWithTheSameIdsIsRefused) {
  Stranger stranger;
  Ft232hGadget gadget(stranger);
  VhciPort port(gadget);
  port.plug();
  expect_failure(palpa(with({"link"}, sweep_of("openmpd:EMU1"))), 1, "its EEPROM: the device refuses it");
  EXPECT_EQ(gadget.bytes_taken, 0u);
}

TEST(FaultsOnUsb, ABoardOfAnotherSerialNumberIsLeftAlone) {
  PluggedBoard board("FTX");
  expect_failure(palpa(with({"link"}, sweep_of("openmpd:EMU1"))), 1, "these are plugged in: FTX");
  EXPECT_EQ(board.gadget.requests, 0u);
  EXPECT_EQ(board.gadget.bytes_taken, 0u);
}

/// A module of the kernel, loaded while this object lives.
class Module {
 public:
  explicit Module(std::string name) : name_(std::move(name)) {
    EXPECT_EQ(run_program("/bin/busybox", {"insmod", "/guest/modules/" + name_ + ".ko"}).exit_code, 0) << name_;
  }
  ~Module() { EXPECT_EQ(run_program("/bin/busybox", {"rmmod", name_}).exit_code, 0) << name_; }
  Module(const Module&) = delete;
  Module& operator=(const Module&) = delete;

 private:
  std::string name_;
};

TEST(FaultsOnUsb, ABoardThatTheKernelMadeASerialPortPlaysAndIsGivenBack) {
  const Module serial("usbserial"), ftdi("ftdi_sio");
  PluggedBoard board("EMU1");
  ASSERT_TRUE(begins([] { return std::filesystem::exists("/dev/ttyUSB0"); }));
  const Result doctor = palpa({"doctor", "--backend", "cpu"});
  EXPECT_CONTAINS(doctor.out, "the kernel uses it as a serial port, which palpa removes");
  Loop loop("link", sweep_of("openmpd:EMU1"));
  EXPECT_TRUE(plays_on(board)) << loop.said();
  EXPECT_FALSE(std::filesystem::exists("/dev/ttyUSB0"));
  EXPECT_EQ(loop.end(), 0);
  EXPECT_EQ(loop.said(), "");
  EXPECT_TRUE(begins([] { return std::filesystem::exists("/dev/ttyUSB0"); })) << "the kernel has it back";
  EXPECT_EQ(board.faults_at_the_end(), none);
}

}  // namespace
}  // namespace palpa::test
