// The contract that every subcommand keeps: exit codes, one-line errors, the places of results.
#include <gtest/gtest.h>

#include "cli/support/here.hpp"
#include "cli/support/process.hpp"
#include "cli/support/told.hpp"
#include "support/files.hpp"
#include "support/instrumented.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa::test {
namespace {

const std::vector<std::string> any_drive{"drive", "--layout", "openmpd", "--focus", "0,0,0.15"},
    drive = with(any_drive, {"--backend", "cpu"});

TEST(Usage, EveryKindOfBadLineIsToldInOneWording) {
  const std::string drive_help = "; see palpa drive --help", help = "; see palpa --help";
  const std::vector<Told> lines{
      {{"tuoch"}, "unknown subcommand 'tuoch': did you mean touch? see palpa --help"},
      {{"help", "tuoch"}, "unknown subcommand 'tuoch': did you mean touch? see palpa --help"},
      {{"feel"}, "unknown subcommand 'feel'" + help},
      {{"help", "wave"}, "unknown subcommand 'wave'" + help},
      {{"help", "touch", "run"}, "give palpa help one subcommand"},
      {{"--feel"}, "palpa has no option '--feel'" + help},
      {{"-"}, "unknown subcommand '-'" + help},
      {{""}, "unknown subcommand ''" + help},
      {{"--quiet", "drive"}, "'--quiet' comes before the subcommand: give it after the subcommand" + drive_help},
      {{"--json", "-", "drive"}, "'--json' comes before the subcommand: give it after the subcommand" + drive_help},
      {{"drive", "--layout"}, "--layout: the value is missing, give NAME|FILE" + drive_help},
      {{"drive", "--layout="}, "--layout: the value is missing, give NAME|FILE" + drive_help},
      {{"drive", "--solver"}, "--solver: the value is missing, give WORD" + drive_help},
      {{"drive", "--json", ""}, "--json"},
      {{"drive", "--layout", "a", "--layout", "a"}, "--layout is given 2 times: give it once" + drive_help},
      {{"drive", "--seed=1", "--seed=2", "--seed=3"}, "--seed is given 3 times: give it once" + drive_help},
      {{"drive", "--quiet=yes"}, "--quiet takes no value: give it alone" + drive_help},
      {{"drive", "--quiet", "yes"},
       "'yes' does not belong to an option: each value follows its own option" + drive_help},
      {{"drive", "--focus", "0,0,1", "0,0,2"},
       "'0,0,2' does not belong to an option: each value follows its own option" + drive_help},
      {{"drive", "touch"}, "'touch' does not belong to an option"},
      {{"drive", ""}, "'' does not belong to an option"},
      {{"drive", "extra\nlines\nhere"}, "'extra\\nlines\\nhere'"},
      {{"drive", "--colour", "red"}, "palpa drive has no option '--colour'" + drive_help},
      {{"drive", "--lay", "autd3"}, "palpa drive has no option '--lay'"},
      {{"drive", "-x"}, "palpa drive has no option '-x'"},
      {{"drive", "--layuot", "autd3"}, "no option '--layuot': did you mean --layout? see palpa drive --help"},
      {{"drive", "--", "--layout", "autd3"}, "'--layout' is not read here: the argument before it ends the options"},
      {{"study"}, "a subcommand is required; see palpa study --help"},
      {{"study", "analyse", ""}, "is empty"},
      {{"study", "analyze"}, "unknown subcommand 'analyze': did you mean analyse? see palpa study --help"},
      {{"help", "study", "pwoer"}, "unknown subcommand 'pwoer': did you mean power? see palpa --help"},
      {{"study", "--seed", "1"}, "palpa study has no option '--seed'; see palpa study --help"},
      {{"study", "power", "--trails", "3"}, "palpa study power has no option '--trails': did you mean --trials?"},
      {{"--quiet", "study", "power"}, "give it after the subcommand; see palpa study power"},
      {{"sweep", "plan.toml", "--out", "x"}, "palpa sweep is now a Python program: python3 -m palpa.sweeps PLAN"}};
  expect_refused({}, lines);
  for (const Told& one : lines) {
    const std::string told = palpa_here(one.more).err;
    for (const char* foreign : {"required but", "At Most", "expected", "override", "extras"})
      EXPECT_EQ(told.find(foreign), std::string::npos) << told;
  }
}

TEST(Usage, ABadValueNamesOptionValueAndRemedy) {
  struct Bad {
    std::string option, value, remedy;
  };
  for (const auto& [option, value, remedy] : std::vector<Bad>{{"--backend", "tpu", "gpu|cpu"},
                                                              {"--log-level", "loud", "quiet|error|warning|info|debug"},
                                                              {"--validation", "all", "off|core|sync|gpu-assisted"},
                                                              {"--seed", "1.5", "whole number"},
                                                              {"--temperature", "warm", "number"},
                                                              {"--sound-speed", "343km", "343m/s"},
                                                              {"--sound-speed", std::string(100000, '3'), "a speed"},
                                                              {"--amplitude", "loud", "distance|uniform"},
                                                              {"--solver", "best", "naive"},
                                                              {"--constraint", "none", "normalise|uniform|clamp"},
                                                              {"--directivity", "up", "omni|piston|t4010a1"},
                                                              {"--focus", "[0,0,0.1]", "is not a point"}}) {
    std::vector<std::string> line = any_drive;
    if (option == "--focus") line.resize(3);
    const Result result = palpa_here(with(line, {option, value}));
    expect_failure(result, 2, option);
    expect_failure(result, 2, remedy);
    if (value.size() < 60) expect_failure(result, 2, value);
  }
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

TEST(Usage, WhatCanHardlyBeMeantIsWarnedOfInOneLine) {
  expect_warned({"drive", "--layout", "openmpd", "--backend", "cpu", "--focus"},
                {{{"0,0,1.99m"}, ""},
                 {{"0,0,2.1m"}, "--focus: '0,0,2.1m' lies 2.1 m from the nearest transducer"},
                 {{"0,0,-1mm"}, "--focus: '0,0,-1mm' lies behind the array"}});
  const std::filesystem::path bare = scratch_folder("cli_usage_bare") / "bare.toml";
  write_text(bare, "[[transducer]]\nposition_m = [0, 0, 0]\naxis = [0, 0, 1]\n");
  expect_warned({"drive", "--layout", bare, "--backend", "cpu", "--focus", "0,0,0.15", "--frequency"},
                {{{"60kHz"}, ""},
                 {{"60.1kHz"}, "--frequency: 60.1 kHz is far from the 40 kHz"},
                 {{"19.9kHz"}, "--frequency: 19.9 kHz is far from the 40 kHz"}});
  expect_warned(with(drive, {"--frequency"}),
                {{{"40kHz"}, ""}, {{"45kHz"}, "--frequency: the boards of openmpd emit 40 kHz only"}});
}

TEST(Usage, VersionGoesToStdoutAndQuietSaysNothing) {
  const Result version = palpa_here({"--version"}), quiet = palpa_here(with(drive, {"--quiet"}));
  EXPECT_TRUE(version.out.starts_with("palpa ")) << version.out;
  EXPECT_EQ(quiet.out, "");
  for (const Result& result : {version, quiet}) {
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_EQ(result.err, "");
  }
}

// files/test_cli_every_option.cpp has the full disk behind stdout.
TEST(Usage, AClosedPipeIsAFailure) {
  RunOptions closed;
  closed.close_stdout_reader = true;
  for (const auto& line : {drive, with(drive, {"--json", "-"}), with(drive, {"--csv", "-"}), {"--help"}, {"--version"}})
    expect_failure(palpa(line, closed), 1, "Broken pipe");
}

TEST(Usage, NoUsableDeviceIsExitCode3) {
  expect_refused(any_drive, {{{"--gpu", "no such device"}, "no such device", 3}});
  const std::vector<std::pair<Environment, std::string>> settings{
      {{{"VK_DRIVER_FILES", "/nonexistent.json"}, {"VK_ICD_FILENAMES", "/nonexistent.json"}},
       "VK_DRIVER_FILES names /nonexistent.json, which does not exist"},
      {{{"VK_DRIVER_FILES", ""}, {"VK_ICD_FILENAMES", "/etc/passwd:/nonexistent.json"}},
       "VK_ICD_FILENAMES names /nonexistent.json, which does not exist"},
      {{{"VK_DRIVER_FILES", ""}, {"VK_ICD_FILENAMES", "/etc/passwd"}},
       "VK_ICD_FILENAMES allows only the drivers of /etc/passwd"},
      {{{"VK_DRIVER_FILES", ""}, {"VK_ICD_FILENAMES", ""}},
       "VK_DRIVER_FILES is set, but empty, and so names no driver: unset it"}};
  for (const auto& [environment, told] : settings)
    expect_failure(palpa(any_drive, {.environment = environment}), 3, told);
  succeeded(palpa(with(drive, {"--quiet"}), {.environment = settings[0].first}));
}

TEST(Usage, TheEnvironmentChoosesTheBackendAndTheValidation) {
  const std::vector<std::string> touch{
      "touch", "--scene", source_file("assets/cube.glb"), "--points", source_file("assets/finger.ply"), "--json", "-"};
  for (const auto& [backend, why] : {std::pair("cpu", "PALPA_BACKEND is cpu"), std::pair("", "there is no GPU")}) {
    const Result result = succeeded(
        palpa(touch, {.environment = {{"PALPA_BACKEND", backend}, {"VK_DRIVER_FILES", "/nonexistent.json"}}}));
    EXPECT_CONTAINS(result.out, R"("backend": "cpu",)");
    EXPECT_CONTAINS(result.out, "\"backend_why\": \"" + std::string(why) + "\",");
  }
  expect_failure(palpa(any_drive, {.environment = {{"PALPA_VALIDATION", "everything"}}}), 2, "PALPA_VALIDATION");
}

/// Lines of every outcome. Some follow a line that leaves state behind in its process: a log level, or warnings that
/// were kept or printed.
std::vector<std::vector<std::string>> lines_of_every_outcome() {
  const std::string cube = source_file("assets/cube.glb"), finger = source_file("assets/finger.ply");
  const std::vector<std::string> touch{"touch",         "--scene", cube,        "--points", finger,
                                       "--penetration", "3mm",     "--backend", "cpu"};
  return {
      {"--help"},
      {"feel"},
      with(drive, {"--frequency", "60.1kHz", "--json", "-"}),
      with(touch, {"--dwell", "51ms", "--gltf-scene", "7"}),
      with(drive, {"--frequency", "60.1kHz"}),
      with(drive, {"--frequency", "60.1kHz", "--log-level", "info", "--csv", "-"}),
      with(drive, {"--frequency", "60.1kHz"}),
      with(drive, {"--log-level", "quiet", "--layout", "openmpd"}),
      with(drive, {"--log-level", "quiet", "--solver", "adjoint"}),
      {},
      {"--version"},
      {"emulate", "--help"},
      with(drive, {"--csv", "-"}),
      with(drive, {"--csv", "/dev/full"}),
      with(drive, {"--csv", "/dev/stdout", "--json", "-"}),
      with(touch, {"--csv", finger}),
      with(touch, {"--csv", "-"}),
      with(any_drive, {"--gpu", "no such device"}),
      {"run", "--scene", cube, "--link", "nobody:"},
      {"run", "--scene", cube, "--source", "bag:none.bag"},
      {"emulate", "autd3", "--port", "0", "--uart"},
  };
}

// Other tests rely on this.
TEST(Usage, ALineInTheTestsProcessSaysWhatTheProgramSays) {
  for (const std::vector<std::string>& line : the_first(6, lines_of_every_outcome())) {
    SCOPED_TRACE(testing::PrintToString(line));
    const Result here = palpa_here(line), program = palpa(line);
    EXPECT_EQ(here.exit_code, program.exit_code);
    EXPECT_EQ(here.out, program.out);
    EXPECT_EQ(here.err, program.err);
  }
}

}  // namespace
}  // namespace palpa::test
