// OpenMPD boards through the real libusb, with umockdev as its kernel and the emulator as the board. The bus in this
// process's memory (test_openmpd_board.cpp) cannot test that libusb is called correctly.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <string>

#include "driver/openmpd/openmpd_rig.hpp"
#include "driver/umockdev_bus.hpp"
#include "driver/usb/libusb.hpp"
#include "support/thrown.hpp"

namespace palpa::test {
namespace {

namespace openmpd = driver::openmpd;
namespace usb = driver::usb;

class LibusbOnUmockdev : public testing::Test {
 protected:
  void SetUp() override {
    if (!UmockdevBus::works()) GTEST_SKIP() << "skipped: ctest runs this with umockdev loaded, umockdev-wrapper does";
    bus = std::make_unique<UmockdevBus>(*rig.emulators[0], rig.clock);
  }
  void TearDown() override {
    rig.board.reset();  // while the bus can still answer it
    bus.reset();
  }
  /// Plays until the board is in step again and sounds, at most for that time.
  bool sounds_within(const array::Drive& drive, double seconds) {
    const auto sounds = [&] { return rig.board->in_step() && rig.notes.warnings.size() > 1 && rig.sounds(); };
    for (const double end_s = rig.clock.now_s() + seconds; rig.clock.now_s() < end_s && !sounds();)
      rig.play(drive, 0.01);
    return sounds();
  }

  OpenMpdRig rig;
  usb::LibusbTransport libusb;
  std::unique_ptr<UmockdevBus> bus;
};

TEST_F(LibusbOnUmockdev, WhatIsSentArrivesAndSilenceIsLast) {
  const usb::Listing listing = libusb.list([](std::uint16_t vendor, std::uint16_t) { return vendor == 0x0403; });
  ASSERT_EQ(listing.entries.size(), 1u) << listing.problem;
  EXPECT_EQ(listing.entries[0].serial, "EMU1");
  EXPECT_EQ(listing.entries[0].place, "1-3");
  EXPECT_EQ(listing.entries[0].release, 0x0900);
  rig.open(libusb);
  EXPECT_GE(bus->resets, 1u);
  const array::Drive drive = focus_drive(rig.layout);
  rig.play(drive, 0.05);
  ASSERT_TRUE(rig.sounds());
  const array::Drive heard = openmpd::heard_drive(rig.emulators[0]->fpga().pulses(), openmpd::Calibration{});
  ASSERT_EQ(heard.size(), drive.size());
  for (std::size_t i = 0; i < drive.size(); ++i) {
    EXPECT_NEAR(heard[i].amplitude, drive[i].amplitude, 0.05) << i;
    const double turn = (heard[i].phase - drive[i].phase) / (2 * std::numbers::pi);
    EXPECT_NEAR(turn, std::round(turn), 1.01 / 256) << "half a step of 128: transducer " << i;
  }
  EXPECT_GT(bus->bulk_transfers, 30u);
  rig.board->all_off();
  EXPECT_TRUE(rig.board->close());
  rig.look();
  EXPECT_FALSE(rig.sounds());
  rig.board.reset();
  EXPECT_EQ(rig.violations(), "");
}

TEST_F(LibusbOnUmockdev, AStallIsClearedAndResynchronised) {
  rig.open(libusb);
  const array::Drive drive = focus_drive(rig.layout);
  rig.play(drive, 0.05);
  const unsigned clears = bus->clears;
  bus->stalled = true;
  rig.play(drive, 0.05);
  EXPECT_FALSE(rig.sounds());
  EXPECT_GT(bus->clears, clears);
  EXPECT_TRUE(sounds_within(drive, 2));
  ASSERT_EQ(rig.notes.warnings.size(), 2u);
  EXPECT_CONTAINS(rig.notes.warnings[0], "refuses");
  EXPECT_CONTAINS(rig.notes.warnings[1], "in step again");
  EXPECT_EQ(rig.violations(), "");
}

TEST_F(LibusbOnUmockdev, UnpluggedItIsFoundAgain) {
  rig.open(libusb);
  const array::Drive drive = focus_drive(rig.layout);
  rig.play(drive, 0.05);
  bus->unplugged = true;
  rig.emulators[0]->unplugged(rig.clock.now_s());
  rig.play(drive, 0.5);
  ASSERT_EQ(rig.notes.warnings.size(), 1u);
  EXPECT_FALSE(rig.board->in_step());
  bus->unplugged = false;
  EXPECT_TRUE(sounds_within(drive, 4));
  ASSERT_EQ(rig.notes.warnings.size(), 2u);
  EXPECT_CONTAINS(rig.notes.warnings[0], "the device is gone");
  EXPECT_CONTAINS(rig.notes.warnings[1], "in step again");
  EXPECT_EQ(rig.violations(), "");
}

}  // namespace
}  // namespace palpa::test
