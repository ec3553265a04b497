// The contract that every subcommand keeps: exit codes, one-line errors, --help, where results go.
#include <gtest/gtest.h>

#include <algorithm>

#include "process.hpp"
#include "support/shared_data.hpp"

namespace palpa::test {
namespace {

const std::vector<std::string> drive{"drive", "--layout", "openmpd", "--focus", "0,0,0.15", "--backend", "cpu"};

TEST(Usage, HelpTeachesAndSucceeds) {
  const Result all = palpa({"--help"});
  EXPECT_EQ(all.exit_code, 0);
  EXPECT_EQ(all.err, "");
  for (const std::string command : {"doctor", "touch", "run", "drive", "decompose", "bench"}) {
    EXPECT_NE(all.out.find(command), std::string::npos);
    const Result one = palpa({command, "--help"});
    EXPECT_EQ(one.exit_code, 0);
    EXPECT_EQ(one.err, "");
    EXPECT_NE(one.out.find("Examples:"), std::string::npos);
    for (const char* option : {"--gpu", "--backend", "--json", "--quiet", "--log-level", "--seed", "--validation"}) {
      EXPECT_NE(one.out.find(option), std::string::npos) << command << " " << option;
    }
    // A tall screen has 60 lines. run has the options of all rooms, 47 in 7 groups.
    EXPECT_LE(std::count(one.out.begin(), one.out.end(), '\n'), command == "run" ? 70 : 60) << command;
  }
}

TEST(Usage, VersionGoesToStdout) {
  const Result result = palpa({"--version"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_TRUE(result.out.starts_with("palpa ")) << result.out;
  EXPECT_EQ(result.err, "");
}

TEST(Usage, ABadLineIsOneLineAndExitCode2) {
  expect_failure(palpa({}), 2, "subcommand is required");
  expect_failure(palpa({"feel"}), 2, "feel");
  expect_failure(palpa({"drive", "--colour", "red"}), 2, "--colour");
  expect_failure(palpa({"drive", "--gpu"}), 2, "--gpu");
  expect_failure(palpa({"drive", "extra\nlines\nhere"}), 2, "extra lines here");
  expect_failure(palpa({"doctor", "drive"}), 2, "drive");
  expect_failure(palpa({"drive", "--json", ""}), 2, "--json");
}

TEST(Usage, ABadValueNamesOptionValueAndRemedy) {
  const auto refused = [](const std::string& option, const std::string& value, const std::string& remedy) {
    const Result result = palpa({"drive", "--layout", "openmpd", "--focus", "0,0,0.15", option, value});
    expect_failure(result, 2, option);
    expect_failure(result, 2, remedy);
    if (value.size() < 60) expect_failure(result, 2, value);
  };
  refused("--backend", "tpu", "gpu|cpu");
  refused("--log-level", "loud", "quiet|error|warning|info|debug");
  refused("--validation", "all", "off|core|sync|gpu-assisted");
  refused("--seed", "-1", "whole number");
  refused("--seed", "18446744073709551616", "whole number");
  refused("--temperature", "-273.15", "above -273.15");
  refused("--temperature", "warm", "number");
  refused("--sound-speed", "0", "above 0");
  refused("--sound-speed", "343km", "343m/s");
  refused("--sound-speed", "inf", "a speed");
  refused("--frequency", "-40kHz", "above 0");
  refused("--amplitude", "loud", "distance|uniform");
  refused("--solver", "best", "naive");
  refused("--constraint", "none", "normalise|uniform|clamp");
  refused("--directivity", "up", "omni|piston|t4010a1");
  refused("--sound-speed", std::string(100000, '3'), "a speed");
}

TEST(Usage, UnitsAreReadAndABareNumberIsSi) {
  const Result units = palpa(with(drive, {"--sound-speed", "343m/s", "--frequency", "40kHz", "--json", "-"}));
  const Result bare = palpa(with(drive, {"--sound-speed", "343", "--frequency", "40000", "--json", "-"}));
  EXPECT_EQ(units.exit_code, 0) << units.err;
  EXPECT_EQ(units.out, bare.out);
}

TEST(Usage, QuietSaysNothing) {
  const Result result = palpa(with(drive, {"--quiet"}));
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_EQ(result.out, "");
  EXPECT_EQ(result.err, "");
}

TEST(Usage, AFullDiskOrAClosedPipeIsAFailure) {
  RunOptions full;
  full.stdout_file = "/dev/full";
  RunOptions closed;
  closed.close_stdout_reader = true;
  const std::vector<std::vector<std::string>> lines{
      drive, with(drive, {"--json", "-"}), with(drive, {"--csv", "-"}), {"--help"}, {"drive", "--help"}, {"--version"}};
  for (const auto& line : lines) {
    expect_failure(palpa(line, full), 1, "No space left on device");
    expect_failure(palpa(line, closed), 1, "Broken pipe");
  }
  expect_failure(palpa(with(drive, {"--json", "/dev/full"})), 1, "/dev/full");
  expect_failure(palpa(with(drive, {"--csv", "/dev/full"})), 1, "/dev/full");
  expect_failure(palpa(with(drive, {"--json", "/nonexistent/folder/x.json"})), 1, "/nonexistent/folder/x.json");
}

TEST(Usage, TwoResultsCannotShareStdout) {
  expect_failure(palpa(with(drive, {"--json", "-", "--csv", "-"})), 2, "--csv");
}

TEST(Usage, NoUsableDeviceIsExitCode3) {
  const std::vector<std::string> gpu{"drive", "--layout", "openmpd", "--focus", "0,0,0.15"};
  expect_failure(palpa(with(gpu, {"--gpu", "no such device"})), 3, "no such device");
  RunOptions none;
  none.environment = {{"VK_DRIVER_FILES", "/nonexistent.json"}, {"VK_ICD_FILENAMES", "/nonexistent.json"}};
  expect_failure(palpa(gpu, none), 3, "mesa-vulkan-drivers");
  const Result cpu = palpa(with(gpu, {"--backend", "cpu", "--quiet"}), none);
  EXPECT_EQ(cpu.exit_code, 0) << cpu.err;
}

TEST(Usage, AMisspeltValidationInTheEnvironmentIsBadUsage) {
  RunOptions options;
  options.environment = {{"PALPA_VALIDATION", "everything"}};
  expect_failure(palpa({"drive", "--layout", "openmpd", "--focus", "0,0,0.15"}, options), 2, "PALPA_VALIDATION");
}

}  // namespace
}  // namespace palpa::test
