// palpa and its guard on real libusb, usbfs and the kernel's own USB core, with an emulated OpenMPD board at the port.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "cli/support/process.hpp"
#include "support/json.hpp"
#include "support/thrown.hpp"
#include "usb/loop.hpp"
#include "usb/plugged_board.hpp"

namespace palpa::test {
namespace {

using nlohmann::json;

const std::vector<std::string> none;

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
  expect_failure(palpa_as("nobody", test), 1, "board EMU1 cannot be opened: Access denied");
  EXPECT_CONTAINS(palpa_as("nobody", {"doctor", "--backend", "cpu"}).out, "70-palpa.rules");
  EXPECT_EQ(board.gadget.requests, 0u);
  succeeded(palpa_as("nobody:plugdev", test));
  EXPECT_EQ(board.pins(), (std::vector<std::size_t>{185}));
  const Result doctor = palpa_as("nobody:plugdev", {"doctor", "--backend", "cpu", "--json", "-"});
  const json boards = json::parse(doctor.out)["boards"];
  ASSERT_EQ(boards.size(), 1u);
  EXPECT_TRUE(boards[0]["place"] == board.port.place() && boards[0]["usable"].get<bool>()) << boards;
  EXPECT_EQ(board.faults_at_the_end(), none);
}

}  // namespace
}  // namespace palpa::test
