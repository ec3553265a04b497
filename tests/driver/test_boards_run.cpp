// `palpa run` with emulated AUTD3 units, and what no board can play: the real programs, with a line between them.
#include <gtest/gtest.h>

#include <cmath>
#include <csignal>
#include <fstream>
#include <numbers>
#include <string>
#include <vector>

#include "cli/support/live_run.hpp"
#include "cli/support/process.hpp"
#include "driver/autd3/emulated/listener.hpp"
#include "driver/boards_run.hpp"
#include "support/begins.hpp"
#include "support/boards.hpp"
#include "support/drive_recording.hpp"
#include "support/files.hpp"
#include "support/json.hpp"
#include "support/occurrences.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa::test {
namespace {

using nlohmann::json;

TEST(Autd3Run, UnitsHearALoopToItsSilentEnd) {
  const auto folder = scratch_folder("autd3-run");
  const std::string address = driver::autd3::Listener(0).address();  // free, and nobody else wants it
  const std::string port = address.substr(address.find(':') + 1);
  LiveOptions options;
  options.command = "emulate";
  LiveRun emulator({"autd3", "--port", port, "--json", (folder / "report.json").string(), "--trace",
                    (folder / "wire.jsonl").string()},
                   options);
  Result result;
  begins([&] {
    result = palpa(with(run_to_board("autd3:" + address, "autd3"), {"--log-level", "info", "--json", "-"}));
    return result.err.find("cannot be reached") == std::string::npos;  // otherwise it does not listen yet
  });
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_CONTAINS(result.err, "plans transferred");
  EXPECT_EQ(occurrences(result.err, ": plays at full amplitude"), 1u) << result.err;
  const Result chosen = palpa(with(run_to_board("autd3:" + address, "autd3"), {"--ceiling", "1"}));
  EXPECT_EQ(chosen.exit_code, 0);
  EXPECT_EQ(occurrences(chosen.err, "plays at full amplitude"), 0u) << chosen.err;
  expect_counts(result.out);
  // Without a layout, the link's own array is one unit.
  const Result own = succeeded(palpa({"link", "test", "--link", "autd3:" + address, "--last", "1", "--each", "20ms",
                                      "--rest", "0", "--log-level", "info"}));
  EXPECT_CONTAINS(own.err, "palpa uses the link's own array, --layout autd3");
  emulator.signal(SIGTERM);
  EXPECT_EQ(emulator.wait(60).exit_code, 0);
  const json report = json::parse(read_text(folder / "report.json"));
  EXPECT_EQ(report["violation_count"], 0) << report;
  EXPECT_FALSE(report["sounds"].get<bool>());
  EXPECT_GT(report["operations"].get<int>(), 20);
  std::ifstream wire(folder / "wire.jsonl");
  std::string line;
  ASSERT_TRUE(std::getline(wire, line));
  const json first = json::parse(line);
  EXPECT_EQ(first["kind"], "tcp");
  EXPECT_EQ(first["hex"], "100100415554443352454d4f5445");
}

/// Two boards whose sounds meet at a place, the second one earlier by one sixteenth of a period after the other.
TEST(LinkTest, ComparesTwoBoards) {
  const auto file = scratch_folder("link-compare") / "drives.bin";
  const Result result =
      succeeded(palpa({"link", "test", "--layout", "openmpd-pair", "--link", "record:" + file.string(), "--compare",
                       "0,0,119.4mm", "--each", "1ms", "--rest", "0", "--dwell", "1ms"}));
  EXPECT_CONTAINS(result.out, "boards 1 and 2, board 2 another 0.0625 periods earlier");
  std::vector<array::Drive> steps;  // a late slot is played once more
  for (const RecordedDrive& one : read_drive_recording(file).drives) {
    if (one.drive[0].amplitude == 0) continue;
    if (steps.empty() || one.drive[256].phase != steps.back()[256].phase) steps.push_back(one.drive);
  }
  ASSERT_EQ(steps.size(), 16u);
  for (std::size_t step = 0; step < steps.size(); ++step) {
    for (std::size_t t = 0; t < 256; ++t) {
      EXPECT_EQ(steps[step][t].phase, steps[0][t].phase) << "the first board stays";
      const double earlier = (steps[0][256 + t].phase - steps[step][256 + t].phase) / (2 * std::numbers::pi);
      EXPECT_NEAR(std::remainder(earlier - static_cast<double>(step) / 16, 1.0), 0, 1e-5);
    }
  }
  // The place is in the middle, and the boards are mirror images.
  EXPECT_NEAR(steps[0][0].phase, steps[0][256 + 240].phase, 1e-2);
}

TEST(BoardsRun, WhatCannotBePlayedToOrEmulatedIsNamed) {
  const struct {
    std::vector<std::string> arguments;
    int code;
    const char* part;
  } cases[] = {
      {{"link"}, 2, "palpa link test"},
      {{"link", "test", "--layout", "openmpd"}, 2, "--link"},
      {{"link", "test", "--link", "null"}, 2, "--layout"},
      {{"link", "test", "--link", "null", "--layout", "openmpd", "--compare", "0,0,1cm"}, 2, "has 1 board"},
      {{"link", "test", "--link", "null", "--layout", "openmpd-pair", "--compare", "0,0"}, 2, "--compare"},
      {{"link", "test", "--link", "null", "--layout", "openmpd-pair", "--compare", "0,0,-1cm"},
       2,
       "--compare 0,0,-1cm is behind board 1 of the layout openmpd-pair"},
      {{"link", "test", "--link", "null", "--layout", "openmpd-pair", "--compare", "0,0,30cm"},
       2,
       "is behind board 2 of the layout openmpd-pair"},
      {{"link", "test", "--link", "null", "--layout", "openmpd-pair", "--compare", "0,0,1cm", "--last", "3"},
       2,
       "leave out"},
      {{"link", "test", "--link", "openmpd:A,B,C"}, 2, "--layout"},
      {{"link", "test", "--link", "null", "--layout", "openmpd", "--first", "7", "--last", "256"}, 2, "0 to 255"},
      {{"emulate"}, 2, "the board is missing"},
      {{"emulate", "matd"}, 2, "unknown board matd"},
      {{"emulate", "autd3", "--layout", "openmpd"}, 2, "not consist of AUTD3 units"},
      {{"emulate", serial_board(), "--layout", "autd3"}, 2, "--layout"},
      {{"emulate", "openmpd", "--serial", "A,B,C", "--view"}, 2, "--layout"},
      {{"emulate", "openmpd", "--board-files", "/nowhere", "--view"}, 4, "/nowhere"},
  };
  const RunOptions no_boards{.environment = {{"XDG_RUNTIME_DIR", scratch_folder("no-boards").string()}}};
  for (const auto& [arguments, code, part] : cases)
    expect_failure(palpa(arguments, no_boards), code, part);
}

}  // namespace
}  // namespace palpa::test
