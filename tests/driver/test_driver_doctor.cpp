// `palpa doctor` with boards and cameras on an emulated USB: umockdev shows libusb a /sys and /dev that do not exist.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <utility>

#include "cli/support/process.hpp"
#include "driver/umockdev_device.hpp"
#include "support/files.hpp"
#include "support/instrumented.hpp"
#include "support/json.hpp"
#include "support/shared_data.hpp"

namespace palpa::test {
namespace {

using nlohmann::json;

/// Skips the test if umockdev is unavailable: it is loaded by LD_PRELOAD, which sanitizers do not support.
#define PALPA_UMOCKDEV_OR_SKIP(variable)                                                                         \
  const std::filesystem::path variable = "/usr/bin/umockdev-run";                                                \
  if (!std::filesystem::exists(variable)) GTEST_SKIP() << "skipped: no umockdev-run (apt-get install umockdev)"; \
  if (instrumented()) GTEST_SKIP() << "skipped: umockdev-run and sanitizers do not go together"

/// `palpa doctor` on those devices, and on no board that somebody emulates.
Result doctor_on(const std::filesystem::path& mock, const std::filesystem::path& devices) {
  // CHARSET: of paths, for umockdev-run.
  return run_program(
      mock, {"--device", devices.string(), "--", palpa_binary(), "doctor", "--json", "-"},
      {.environment = {{"CHARSET", "UTF-8"}, {"XDG_RUNTIME_DIR", scratch_folder("no-boards").string()}}});
}

TEST(DriverDoctor, FindsBoardsAndCamerasOnUsb) {
  PALPA_UMOCKDEV_OR_SKIP(mock);
  const auto file = scratch_folder("usb") / "usb.umockdev";
  std::ofstream(file) << describe({"3", 19, "0403", "6014", "FTY4PDOI"}) << describe({"1", 7, "1a86", "7523", ""})
                      << describe({"4", 21, "2341", "0042", "85430353531351B0D1E1"})
                      << describe({"2", 12, "8086", "0ad3", "728612070259"}) << describe({"5", 30, "04d9", "1603", ""});
  const Result result = doctor_on(mock, file);
  ASSERT_TRUE(result.exit_code == 0 || result.exit_code == 3) << result.err;
  const json report = json::parse(result.out);
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
  EXPECT_NE(ft232h["advice"].get<std::string>().find("serial number"), std::string::npos);
  EXPECT_EQ(report["boards"][2]["id"], "2341:0042");
  ASSERT_GE(report["cameras"].size(), 1u);
  EXPECT_EQ(report["cameras"][0]["id"], "8086:0ad3");
  EXPECT_EQ(report["cameras"][0]["serial"], "728612070259");
}

/// Each device for which palpa's rules of udev ask, each RealSense of the D400 series, and all of them behind hubs.
TEST(DriverDoctor, FindsAllThatItsRulesAreForBehindHubsToo) {
  PALPA_UMOCKDEV_OR_SKIP(mock);
  std::set<std::string> boards;
  const std::string rules = read_text(source_file("driver/70-palpa.rules"));
  const std::regex rule(R"re(idVendor\}=="(\w+)"(?:, ATTRS?\{idProduct\}=="(\w+)")?)re");
  for (std::sregex_iterator one(rules.begin(), rules.end(), rule), end; one != end; ++one)
    boards.insert((*one)[1].str() + ":" + ((*one)[2].matched ? (*one)[2].str() : "0043"));
  ASSERT_EQ(boards.size(), 6u);
  const std::set<std::string> cameras{"8086:0ad3", "8086:0b07", "8086:0b3a", "8086:0b5b", "8086:0b5c"};
  const auto file = scratch_folder("usb-hubs") / "usb.umockdev";
  std::ofstream out(file);
  out << describe({"4", 2, "05e3", "0608", "HUB"}) << describe({"4.2", 3, "05e3", "0610", "HUB2"});
  int address = 10;
  std::map<std::string, std::string> places;
  for (const auto& ids : {boards, cameras}) {
    for (const std::string& id : ids) {
      const std::string ports = fmt::format("4.2.{}", ++address - 8);
      places[id] = "1-" + ports;
      out << describe({ports, address, id.substr(0, 4), id.substr(5), "AT" + ports});
    }
  }
  out.close();
  const json report = json::parse(doctor_on(mock, file).out);
  for (const auto& [kind, ids] : {std::pair("boards", boards), {"cameras", cameras}}) {
    std::set<std::string> found;
    for (const json& one : report[kind]) {
      if (!one.contains("bus")) continue;
      const std::string id = one["id"];
      found.insert(id);
      EXPECT_EQ(one["place"], places[id]) << id;
      EXPECT_EQ(one["serial"], "AT" + places[id].substr(2)) << id;
      EXPECT_TRUE(kind == std::string("cameras") || !one["advice"].get<std::string>().empty()) << id;
    }
    EXPECT_EQ(found, ids);
  }
}

TEST(DriverDoctor, ADeviceThatMayNotBeOpenedIsExplained) {
  PALPA_UMOCKDEV_OR_SKIP(mock);
  const auto file = scratch_folder("usb-forbidden") / "usb.umockdev";
  // sysfs announces the node, but it cannot be opened.
  std::string device = describe({"3", 19, "0403", "6014", "FTY4PDOI"});
  device.erase(device.find("N: "), device.find("E: DEVNAME") - device.find("N: "));
  std::string camera = describe({"2", 12, "8086", "0ad3", "728612070259"});
  camera.erase(camera.find("N: "), camera.find("E: DEVNAME") - camera.find("N: "));
  std::ofstream(file) << device << camera;
  const Result result = doctor_on(mock, file);
  const json report = json::parse(result.out);
  ASSERT_EQ(report["boards"].size(), 1u);
  EXPECT_FALSE(report["boards"][0]["usable"].get<bool>());
  EXPECT_EQ(report["boards"][0]["serial"], "FTY4PDOI");
  EXPECT_NE(report["boards"][0]["advice"].get<std::string>().find("cannot be opened"), std::string::npos);
  // The kernel opens it.
  EXPECT_TRUE(report["cameras"][0]["usable"].get<bool>()) << report["cameras"][0];
}

}  // namespace
}  // namespace palpa::test
