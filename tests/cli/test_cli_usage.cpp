// The contract that every subcommand keeps: exit codes, one-line errors, --help, the places of results.
#include <gtest/gtest.h>

#include <algorithm>

#include "cli/support/here.hpp"
#include "cli/support/process.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa::test {
namespace {

const std::vector<std::string> drive{"drive", "--layout", "openmpd", "--focus", "0,0,0.15", "--backend", "cpu"};

TEST(Usage, VersionGoesToStdout) {
  const Result result = palpa({"--version"});
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_TRUE(result.out.starts_with("palpa ")) << result.out;
  EXPECT_EQ(result.err, "");
}

TEST(Usage, ABadLineIsOneLineAndExitCode2) {
  expect_failure(palpa({"tuoch"}), 2, "unknown subcommand 'tuoch': did you mean touch? see palpa --help");
  expect_failure(palpa({"feel"}), 2, "feel");
  expect_failure(palpa({"drive", "--colour", "red"}), 2, "--colour");
  expect_failure(palpa({"drive", "--gpu"}), 2, "--gpu");
  expect_failure(palpa({"drive", "extra\nlines\nhere"}), 2, "'extra\\nlines\\nhere'");
  expect_failure(palpa({"doctor", "drive"}), 2, "drive");
  expect_failure(palpa({"drive", "--json", ""}), 2, "--json");
  expect_failure(palpa({"sweep", "plan.toml", "--out", "x"}), 2,
                 "palpa sweep is now a Python program: python3 -m palpa.sweeps PLAN");
}

TEST(Usage, OneCameraBesideTheDefaultRigIsOfferedARigOfItsOwn) {
  const std::vector<std::string> run{"run", "--scene", source_file("assets/cube.glb"), "--backend", "cpu", "--source"};
  for (const char* source : {"v4l2:/dev/video0", "realsense:123"}) {
    const Result result = palpa_here(with(run, {source}));
    if (result.err.find("this palpa was built without librealsense2") != std::string::npos) continue;
    expect_failure(result, 2, "names 1 camera, but " + source_file("assets/rigs/paper.toml").string() + " describes 3");
    expect_failure(result, 2, "palpa doctor --write-rig FILE writes a rig for the cameras that are plugged in");
  }
}

TEST(Usage, EveryKindOfBadLineIsToldInOneWording) {
  const auto refused = [](const std::vector<std::string>& line, const std::string& told) {
    const Result result = palpa_here(line);
    expect_failure(result, 2, told);
    for (const char* foreign : {"required but", "At Most", "expected", "override", "extras"})
      EXPECT_EQ(result.err.find(foreign), std::string::npos) << result.err;
  };
  const std::string drive_help = "; see palpa drive --help", help = "; see palpa --help";
  refused({"dirve"}, "unknown subcommand 'dirve': did you mean drive? see palpa --help");
  refused({"feel"}, "unknown subcommand 'feel'" + help);
  refused({"--feel"}, "palpa has no option '--feel'" + help);
  refused({"-"}, "unknown subcommand '-'" + help);
  refused({""}, "unknown subcommand ''" + help);
  refused({"--quiet", "drive"}, "'--quiet' comes before the subcommand: give it after the subcommand" + drive_help);
  refused({"--json", "-", "drive"}, "'--json' comes before the subcommand: give it after the subcommand" + drive_help);
  refused({"drive", "--layout"}, "--layout: the value is missing, give NAME|FILE" + drive_help);
  refused({"drive", "--layout="}, "--layout: the value is missing, give NAME|FILE" + drive_help);
  refused({"drive", "--solver"}, "--solver: the value is missing, give WORD" + drive_help);
  refused({"drive", "--layout", "a", "--layout", "a"}, "--layout is given 2 times: give it once" + drive_help);
  refused({"drive", "--seed=1", "--seed=2", "--seed=3"}, "--seed is given 3 times: give it once" + drive_help);
  refused({"drive", "--quiet=yes"}, "--quiet takes no value: give it alone" + drive_help);
  refused({"drive", "--quiet", "yes"},
          "'yes' does not belong to an option: each value follows its own option" + drive_help);
  refused({"drive", "--focus", "0,0,1", "0,0,2"},
          "'0,0,2' does not belong to an option: each value follows its own option" + drive_help);
  refused({"drive", "touch"}, "'touch' does not belong to an option");
  refused({"drive", ""}, "'' does not belong to an option");
  refused({"drive", "--colour", "red"}, "palpa drive has no option '--colour'" + drive_help);
  refused({"drive", "--lay", "autd3"}, "palpa drive has no option '--lay'");
  refused({"drive", "-x"}, "palpa drive has no option '-x'");
  refused({"drive", "--layuot", "autd3"},
          "palpa drive has no option '--layuot': did you mean --layout? see palpa drive --help");
  refused({"drive", "--", "--layout", "autd3"}, "'--layout' is not read here: the argument before it ends the options");
}

TEST(Usage, AValueInBracketsIsOneValue) {
  expect_failure(palpa_here(with(drive, {"--focus", "[0,0,0.1]"})), 2, "'[0,0,0.1]' is not a point");
}

TEST(Usage, WhatCanHardlyBeMeantIsWarnedOfInOneLine) {
  const auto warned = [](const std::vector<std::string>& line, const std::string& told) {
    const Result result = palpa(line);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    ASSERT_EQ(result.err_lines().size(), told.empty() ? 0u : 1u) << result.err;
    if (told.empty()) return;
    EXPECT_NE(result.err.find("palpa: warning: " + told), std::string::npos) << result.err;
  };
  const std::vector<std::string> alone{"drive", "--layout", "openmpd", "--backend", "cpu"};
  warned(with(alone, {"--focus", "0,0,1.99m"}), "");
  warned(with(alone, {"--focus", "0,0,2.1m"}), "--focus: '0,0,2.1m' lies 2.1 m from the nearest transducer");
  warned(with(alone, {"--focus", "0,0,-1mm"}), "--focus: '0,0,-1mm' lies behind the array");
  warned(with(drive, {"--frequency", "60kHz"}), "");
  warned(with(drive, {"--frequency", "60.1kHz"}), "--frequency: 60.1 kHz is far from the 40 kHz");
  warned(with(drive, {"--frequency", "19.9kHz"}), "--frequency: 19.9 kHz is far from the 40 kHz");
}

TEST(Usage, ABadValueNamesOptionValueAndRemedy) {
  const auto refused = [](const std::string& option, const std::string& value, const std::string& remedy) {
    const Result result = palpa_here({"drive", "--layout", "openmpd", "--focus", "0,0,0.15", option, value});
    expect_failure(result, 2, option);
    expect_failure(result, 2, remedy);
    if (value.size() < 60) expect_failure(result, 2, value);
  };
  refused("--backend", "tpu", "gpu|cpu");
  refused("--log-level", "loud", "quiet|error|warning|info|debug");
  refused("--validation", "all", "off|core|sync|gpu-assisted");
  refused("--seed", "-1", "whole number");
  refused("--seed", "18446744073709551616", "whole number");
  for (const char* value : {"-60.1", "100.1", "293.15", "-273.15", "1e300"})
    refused("--temperature", value, "from -60 to 100");
  refused("--temperature", "warm", "number");
  for (const char* value : {"0", "99", "2001", "343000"})
    refused("--sound-speed", value, "from 100m/s to 2000m/s");
  refused("--sound-speed", "343km", "343m/s");
  refused("--sound-speed", "inf", "a speed");
  for (const char* value : {"-40kHz", "40", "999Hz", "10.1MHz"})
    refused("--frequency", value, "from 1kHz to 10000kHz");
  refused("--amplitude", "loud", "distance|uniform");
  refused("--solver", "best", "naive");
  refused("--constraint", "none", "normalise|uniform|clamp");
  refused("--directivity", "up", "omni|piston|t4010a1");
  refused("--sound-speed", std::string(100000, '3'), "a speed");
}

TEST(Usage, UnitsAreReadAndABareNumberIsSi) {
  const Result units = palpa_here(with(drive, {"--sound-speed", "343m/s", "--frequency", "40kHz", "--json", "-"}));
  const Result bare = palpa_here(with(drive, {"--sound-speed", "343", "--frequency", "40000", "--json", "-"}));
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
  expect_failure(palpa(gpu, none), 3, "VK_DRIVER_FILES names /nonexistent.json, which does not exist");
  none.environment = {{"VK_DRIVER_FILES", ""}, {"VK_ICD_FILENAMES", "/etc/passwd:/nonexistent.json"}};
  expect_failure(palpa(gpu, none), 3, "VK_ICD_FILENAMES names /nonexistent.json, which does not exist");
  none.environment = {{"VK_DRIVER_FILES", ""}, {"VK_ICD_FILENAMES", "/etc/passwd"}};
  expect_failure(palpa(gpu, none), 3, "VK_ICD_FILENAMES allows only the drivers of /etc/passwd");
  none.environment = {{"VK_DRIVER_FILES", ""}, {"VK_ICD_FILENAMES", ""}};
  expect_failure(palpa(gpu, none), 3, "VK_DRIVER_FILES is set, but empty, and so names no driver: unset it");
  const Result cpu = palpa(with(gpu, {"--backend", "cpu", "--quiet"}), none);
  EXPECT_EQ(cpu.exit_code, 0) << cpu.err;
}

TEST(Usage, TheEnvironmentChoosesTheBackend) {
  const std::vector<std::string> touch{
      "touch", "--scene", source_file("assets/cube.glb"), "--points", source_file("assets/finger.ply"), "--json", "-"};
  RunOptions options;
  options.environment = {{"PALPA_BACKEND", "cpu"}, {"VK_DRIVER_FILES", "/nonexistent.json"}};
  const Result cpu = palpa(touch, options);
  EXPECT_EQ(cpu.exit_code, 0) << cpu.err;
  EXPECT_CONTAINS(cpu.out, R"("backend": "cpu",)");
  EXPECT_CONTAINS(cpu.out, R"("backend_why": "PALPA_BACKEND is cpu",)");
  options.environment = {{"PALPA_BACKEND", ""}, {"VK_DRIVER_FILES", "/nonexistent.json"}};
  const Result none = palpa(touch, options);
  EXPECT_EQ(none.exit_code, 0) << none.err;
  EXPECT_CONTAINS(none.out, R"("backend_why": "there is no GPU",)");
  expect_failure(palpa(with(touch, {"--gpu", "0"}), options), 3, "does not exist");
  options.environment = {{"PALPA_BACKEND", "cuda"}};
  expect_failure(palpa(touch, options), 2, "PALPA_BACKEND is 'cuda': give auto, gpu or cpu");
}

TEST(Usage, AMisspeltValidationInTheEnvironmentIsBadUsage) {
  RunOptions options;
  options.environment = {{"PALPA_VALIDATION", "everything"}};
  expect_failure(palpa({"drive", "--layout", "openmpd", "--focus", "0,0,0.15"}, options), 2, "PALPA_VALIDATION");
}

}  // namespace
}  // namespace palpa::test
