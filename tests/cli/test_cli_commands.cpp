// A subcommand that a room above the engine adds works like palpa's own.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "cli/commands.hpp"
#include "line/values.hpp"
#include "sensing/rig.hpp"
#include "support/files.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa::test {
namespace {

struct PingCommand {
  setup::CommonOptions common;
  std::string board;
  double pause_s = 0.5;
};

void add_options(CLI::App& app, PingCommand& o) {
  const line::Group group(app, "What to ping");
  group.text("--board", o.board, "NAME", "which board");
  group.quantity("--pause", o.pause_s, Quantity::time, line::positive(10), "between two of them");
}

struct Outcome {
  int code = 0;
  std::string out, err;
  std::vector<PingCommand> pinged{};
};

Outcome palpa_with(const cli::Extensions& extensions, const std::vector<const char*>& words) {
  std::vector<const char*> argv{"palpa"};
  argv.insert(argv.end(), words.begin(), words.end());
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  const int code = cli::main(static_cast<int>(argv.size()), argv.data(), extensions);
  return {code, testing::internal::GetCapturedStdout(), testing::internal::GetCapturedStderr()};
}

Outcome palpa_with_ping(const std::vector<const char*>& words) {
  std::vector<PingCommand> pinged;
  cli::Extensions extensions;
  extensions.commands.push_back([&](cli::Program& program) {
    cli::add_subcommand<PingCommand>(program, {"ping", "whether a board answers", "  palpa ping --board one"},
                                     add_options, [&](const PingCommand& o) {
                                       if (o.board.empty()) throw bad_usage("--board is missing: give a name");
                                       if (o.board == "dead") throw failure("board dead: does not answer");
                                       pinged.push_back(o);
                                     });
  });
  Outcome outcome = palpa_with(extensions, words);
  outcome.pinged = pinged;
  return outcome;
}

TEST(CliCommands, OneFromAboveRunsWithItsOptionsAndTheCommonOnes) {
  const Outcome outcome = palpa_with_ping({"ping", "--board", "one", "--pause", "20ms", "--seed", "7"});
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  ASSERT_EQ(outcome.pinged.size(), 1u);
  EXPECT_EQ(outcome.pinged[0].board, "one");
  EXPECT_EQ(outcome.pinged[0].pause_s, 0.02);
  EXPECT_EQ(outcome.pinged[0].common.seed, 7u);
}

TEST(CliCommands, OneFromAboveFailsAsPalpasOwnDo) {
  const Outcome usage = palpa_with_ping({"ping"});
  EXPECT_EQ(usage.code, static_cast<int>(Exit::usage));
  EXPECT_EQ(usage.err, "palpa: error: --board is missing: give a name\n");
  const Outcome range = palpa_with_ping({"ping", "--pause", "1h"});
  EXPECT_EQ(range.code, static_cast<int>(Exit::usage));
  const Outcome failed = palpa_with_ping({"ping", "--board", "dead"});
  EXPECT_EQ(failed.code, static_cast<int>(Exit::failed));
  EXPECT_EQ(failed.err, "palpa: error: board dead: does not answer\n");
  EXPECT_TRUE(usage.pinged.empty() && range.pinged.empty() && failed.pinged.empty());
}

TEST(CliCommands, DoctorWritesARigForTheCamerasThatAreThere) {
  const std::string file = (scratch_folder("doctor-rig") / "rig.toml").string();
  cli::CamerasThere there{.source = "v4l2:/dev/video0,/dev/video4", .cameras = {}, .problem = "/dev/video6: busy"};
  cli::Extensions extensions;
  extensions.cameras = [&] { return there; };
  const std::vector<const char*> line{"doctor", "--quiet", "--write-rig", file.c_str()};
  const Outcome nobody = palpa_with(extensions, line);
  EXPECT_EQ(nobody.code, static_cast<int>(Exit::failed));
  EXPECT_EQ(nobody.err, "palpa: error: --write-rig: no depth camera can be opened: /dev/video6: busy\n");
  EXPECT_FALSE(std::filesystem::exists(file));
  for (const char* name : {"A", "B"}) {
    cli::CameraThere& camera = there.cameras.emplace_back();
    camera.camera.name = name;
    camera.camera.width = 640;
    camera.camera.height = 480;
    camera.camera.fx = camera.camera.fy = 500;
    camera.camera.device.own_lens = true;
    camera.note = "which it is";
  }
  EXPECT_EQ(palpa_with(extensions, line).err, "");
  const sensing::Rig rig = sensing::load_rig(file);
  ASSERT_EQ(rig.cameras.size(), 2u);
  EXPECT_EQ(rig.cameras[1].name, "B");
  EXPECT_TRUE(rig.cameras[1].device.own_lens);
  EXPECT_EQ(rig.cameras[1].T_world_camera, Transform(1.0));
  const std::string text = read_text(file);
  EXPECT_CONTAINS(text, "palpa calibrate --rig " + file + " --layout LAYOUT --source v4l2:/dev/video0,/dev/video4");
  EXPECT_CONTAINS(text, "T_world_camera is not known yet");
  EXPECT_EQ(palpa_with(extensions, {"doctor", "--write-rig", file.c_str(), "--source", "synthetic"}).code,
            static_cast<int>(Exit::usage));
}

TEST(CliCommands, OneFromAboveStandsInTheHelpBelowTheEngines) {
  const Outcome all = palpa_with_ping({"--help"});
  const std::size_t ping = all.out.find("whether a board answers"), bench = all.out.find("  bench ");
  EXPECT_NE(ping, std::string::npos) << all.out;
  EXPECT_LT(bench, ping);
  const Outcome one = palpa_with_ping({"ping", "--help"});
  EXPECT_CONTAINS(one.out, "--pause");
  EXPECT_CONTAINS(one.out, "--validation");
  EXPECT_CONTAINS(one.out, "palpa ping --board one");
}

}  // namespace
}  // namespace palpa::test
