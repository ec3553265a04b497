// `palpa doctor` with boards and cameras on an emulated USB: umockdev shows libusb a /sys and /dev that do not exist.
#include <gtest/gtest.h>

#include <cctype>
#include <filesystem>
#include <string>

#include "cli/support/process.hpp"
#include "support/files.hpp"
#include "support/instrumented.hpp"
#include "support/json.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa::test {
namespace {

using nlohmann::json;

struct FakeDevice {
  int port, address;
  std::string vendor, product;  ///< four hex digits
  std::string serial;
  bool opens = true;  ///< otherwise, sysfs announces a node that is not there
};

/// Low byte first; umockdev requires capitals.
std::string swapped(const std::string& hex) {
  std::string bytes = hex.substr(2, 2) + hex.substr(0, 2);
  for (char& c : bytes)
    c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return bytes;
}

/// One device as umockdev reads it. The descriptors are those of a real FT232H module: one vendor interface with two
/// bulk endpoints of 512 bytes.
std::string describe(const FakeDevice& d) {
  const std::string descriptors = "1201000200000040" + swapped(d.vendor) + swapped(d.product) +
                                  "000901020301"
                                  "09022000010100A02D0904000002FFFFFF020705810200020007050202000200";
  const std::string address = (d.address < 10 ? "00" : "0") + std::to_string(d.address);
  return "P: /devices/pci0000:00/0000:00:14.0/usb1/1-" + std::to_string(d.port) + "\n" +
         (d.opens ? "N: bus/usb/001/" + address + "=" + descriptors + "\n" : "") + "E: DEVNAME=/dev/bus/usb/001/" +
         address + "\nE: DEVTYPE=usb_device\nE: DRIVER=usb\nE: BUSNUM=001\nE: DEVNUM=" + address +
         "\nE: MAJOR=189\nE: MINOR=" + std::to_string(d.address - 1) +
         "\nE: SUBSYSTEM=usb\nA: bConfigurationValue=1\nA: bNumConfigurations=1\nA: busnum=1\nH: descriptors=" +
         descriptors + "\nA: devnum=" + std::to_string(d.address) + "\nA: devpath=" + std::to_string(d.port) +
         "\nA: idProduct=" + d.product + "\nA: idVendor=" + d.vendor +
         (d.serial.empty() ? "" : "\nA: serial=" + d.serial) + "\nA: speed=480\n\n";
}

class DriverDoctor : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(mock_)) GTEST_SKIP() << "skipped: no umockdev-run (apt-get install umockdev)";
    // It is loaded by LD_PRELOAD.
    if (instrumented()) GTEST_SKIP() << "skipped: umockdev-run and sanitizers do not go together";
  }
  json report_on(const std::string& devices) const {
    const auto file = scratch_folder("usb") / "usb.umockdev";
    write_text(file, devices);
    const Result result = run_program(mock_, {"--device", file.string(), "--", palpa_binary(), "doctor", "--json", "-"},
                                      {.environment = {{"CHARSET", "UTF-8"}}});  // of paths, for umockdev-run
    EXPECT_TRUE(result.exit_code == 0 || result.exit_code == 3) << result.err;
    return json::parse(result.out);
  }
  const std::filesystem::path mock_ = "/usr/bin/umockdev-run";
};

TEST_F(DriverDoctor, FindsBoardsAndCamerasOnUsb) {
  const json report =
      report_on(describe({3, 19, "0403", "6014", "FTY4PDOI"}) + describe({1, 7, "1a86", "7523", ""}) +
                describe({4, 21, "2341", "0042", "85430353531351B0D1E1"}) +
                describe({2, 12, "8086", "0ad3", "728612070259"}) + describe({5, 30, "04d9", "1603", ""}));
  ASSERT_EQ(report["boards"].size(), 3u) << report["boards"];
  const json& ch340 = report["boards"][0];
  EXPECT_EQ(ch340["id"], "1a86:7523");
  EXPECT_EQ(ch340["address"], 7);
  EXPECT_EQ(ch340["serial"], "");
  const json& ft232h = report["boards"][1];
  EXPECT_EQ(ft232h["id"], "0403:6014");
  EXPECT_EQ(ft232h["chip"], "FT232H");
  EXPECT_EQ(ft232h["bus"], 1);
  EXPECT_EQ(ft232h["address"], 19);
  EXPECT_EQ(ft232h["serial"], "FTY4PDOI");
  EXPECT_TRUE(ft232h["usable"].get<bool>());
  // Many other devices have the same chip.
  EXPECT_CONTAINS(ft232h["advice"].get<std::string>(), "serial number");
  EXPECT_EQ(report["boards"][2]["id"], "2341:0042");
  ASSERT_GE(report["cameras"].size(), 1u);
  EXPECT_EQ(report["cameras"][0]["id"], "8086:0ad3");
  EXPECT_EQ(report["cameras"][0]["serial"], "728612070259");
}

TEST_F(DriverDoctor, ADeviceThatMayNotBeOpenedIsExplained) {
  const json report = report_on(describe({3, 19, "0403", "6014", "FTY4PDOI", false}) +
                                describe({2, 12, "8086", "0ad3", "728612070259", false}));
  ASSERT_EQ(report["boards"].size(), 1u);
  EXPECT_FALSE(report["boards"][0]["usable"].get<bool>());
  EXPECT_EQ(report["boards"][0]["serial"], "FTY4PDOI");
  EXPECT_CONTAINS(report["boards"][0]["advice"].get<std::string>(), "cannot be opened");
  // The kernel opens it.
  EXPECT_TRUE(report["cameras"][0]["usable"].get<bool>()) << report["cameras"][0];
}

}  // namespace
}  // namespace palpa::test
