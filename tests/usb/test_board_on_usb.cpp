// palpa and its guard on real libusb, usbfs and the kernel's own USB core, with an emulated OpenMPD board at the port.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "cli/support/process.hpp"
#include "support/json.hpp"
#include "support/shared_data.hpp"
#include "usb/loop.hpp"
#include "usb/plugged_board.hpp"

namespace palpa::test {
namespace {

using nlohmann::json;

const std::vector<std::string> none;

TEST(BoardOnUsb, IsFoundByDoctor) {
  PluggedBoard board("EMU1");
  const Result result = palpa({"doctor", "--backend", "cpu", "--json", "-"});
  const json boards = json::parse(result.out)["boards"];
  ASSERT_EQ(boards.size(), 1u) << result.out << result.err;
  EXPECT_EQ(boards[0]["serial"], "EMU1");
  EXPECT_EQ(boards[0]["place"], board.port.place());
  EXPECT_TRUE(boards[0]["usable"].get<bool>()) << boards;
  EXPECT_EQ(board.faults_at_the_end(), none);
}

TEST(BoardOnUsb, PlaysOneTransducerAfterTheOther) {
  PluggedBoard board("EMU1");
  const Result result = palpa({"link", "test", "--layout", "openmpd", "--link", "openmpd:EMU1", "--first", "64",
                               "--last", "65", "--each", "100ms", "--rest", "60ms"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(board.pins(), (std::vector<std::size_t>{185, 189})) << "as the boards' own files have it";
  EXPECT_EQ(board.faults_at_the_end(), none);
}

/// Debian's udev with the rules that palpa installs, while this object lives. Without it, the guest has none.
class Udev {
 public:
  Udev() { EXPECT_EQ(run_program("/lib/systemd/systemd-udevd", {"--daemon"}, in_guest()).exit_code, 0); }
  ~Udev() { EXPECT_EQ(udevadm({"control", "--exit"}), 0); }
  Udev(const Udev&) = delete;
  Udev& operator=(const Udev&) = delete;
  /// Returns when udev has finished all pending work.
  void settle() { EXPECT_EQ(udevadm({"settle"}), 0); }

 private:
  static RunOptions in_guest() { return {.environment = {{"LD_LIBRARY_PATH", "/bin"}}}; }
  static int udevadm(const std::vector<std::string>& arguments) {
    return run_program("/bin/udevadm", arguments, in_guest()).exit_code;
  }
};

TEST(BoardOnUsb, OpensForTheGroupThatTheRulesName) {
  Udev udev;
  PluggedBoard board("EMU1");
  udev.settle();
  const std::vector<std::string> test = with({"link"}, {"test", "--layout", "openmpd", "--link", "openmpd:EMU1",
                                                        "--first", "64", "--last", "64", "--each", "100ms"});
  expect_failure(palpa_as("nobody", test), 1, "Access denied");
  const Result result = palpa_as("nobody:plugdev", test);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(board.pins(), (std::vector<std::size_t>{185}));
  EXPECT_EQ(board.faults_at_the_end(), none);
}

TEST(BoardOnUsb, HearsALoopToItsSilentEnd) {
  PluggedBoard left("EMU1"), right("EMU2");
  const Result result = palpa({"run", "--scene", source_file("assets/cube.glb").string(), "--backend", "cpu",
                               "--frames", "8", "--every-frame", "--hold", "1s", "--layout", "openmpd-pair", "--link",
                               "openmpd:EMU1,EMU2", "--json", "-"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const json report = json::parse(result.out);
  EXPECT_EQ(report["frames"]["planned"], 8);
  EXPECT_GT(report["drives"]["sent"], report["drives"]["silent"]);
  EXPECT_GT(left.gadget.bytes_taken, 20u * 512) << "frames, and not only what brings it in step";
  EXPECT_EQ(left.gadget.bytes_taken, right.gadget.bytes_taken);
  EXPECT_EQ(left.faults_at_the_end(), none);
  EXPECT_EQ(right.faults_at_the_end(), none);
}

}  // namespace
}  // namespace palpa::test
