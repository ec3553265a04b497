// `palpa run --record`: all frames, or how many are missing; and what --overwrite replaces.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "cli/support/here.hpp"
#include "cli/support/process.hpp"
#include "sensing/recording.hpp"
#include "session/watch/stats.hpp"
#include "setup/sessions/live_run.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa::test {
namespace {

namespace fs = std::filesystem;

class CliRecording : public testing::Test {
 protected:
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::vector<std::string> run(const std::vector<std::string>& more) const {
    return with(with({"run", "--scene", source_file("assets/cube.glb").string(), "--backend", "cpu"}, small_frames()),
                more);
  }
  /// From a recording, which has no noise to leave out.
  std::vector<std::string> replay(const std::vector<std::string>& more) const {
    return with({"run", "--scene", source_file("assets/cube.glb").string(), "--backend", "cpu", "--layout", "paper",
                 "--every-frame"},
                more);
  }
  void expect_untouched(const std::vector<std::string>& line, const std::string& part) {
    const auto before = contents_of(folder_);
    expect_failure(palpa_here(line), 2, part);
    EXPECT_TRUE(contents_of(folder_) == before) << testing::PrintToString(line);
  }

  fs::path folder_ = scratch_folder("cli-recording");
};

TEST_F(CliRecording, HasEveryFrameOfALiveRun) {
  const Result result = succeeded(palpa_here(run({"--frames", "90", "--hold", "auto", "--record", path("take")})));
  EXPECT_EQ(result.err.find(path("take")), std::string::npos) << result.err;
  EXPECT_TRUE(result.out.starts_with(path("take") + ": all 90 frames are recorded\n")) << result.out;
  EXPECT_EQ(sensing::load_recording(path("take")).entries.size(), 90u);
}

TEST_F(CliRecording, OrTheFirstLineSaysHowManyAreMissing) {
  session::LoopStats stats;
  stats.captured = 90;
  EXPECT_TRUE(setup::summary(stats).starts_with("90 frames, "));
  EXPECT_EQ(setup::summary(stats).find("nothing sounds"), std::string::npos);
  EXPECT_CONTAINS(setup::summary(stats, "", 0), "\nthe ceiling is 0: nothing sounds\n");
  EXPECT_TRUE(setup::summary(stats, "take1").starts_with("take1: all 90 frames are recorded\n90 frames, "));
  stats.unrecorded = 47;
  EXPECT_TRUE(setup::summary(stats, "take1").starts_with("take1: 47 of 90 frames are missing; "));
}

TEST_F(CliRecording, IsReplacedOnlyIfTheUserAsksForThat) {
  succeeded(palpa_here(run({"--frames", "4", "--every-frame", "--record", path("take")})));
  const auto two = run({"--frames", "2", "--every-frame", "--seed", "5", "--record", path("take")});
  expect_untouched(two, "--record: " + path("take") +
                            " is not empty; name a new folder, or give --overwrite to replace the recording in it");
  for (const char* name : {"take", "take/"}) {
    succeeded(palpa_here(run({"--frames", "2", "--every-frame", "--record", path(name), "--overwrite", "--quiet"})));
    EXPECT_EQ(sensing::load_recording(path("take")).entries.size(), 2u);
    EXPECT_FALSE(fs::exists(path("take/000002-0.png")));
  }
  // A new folder is as good, and a run that cannot begin replaces nothing.
  succeeded(palpa_here(run({"--frames", "1", "--record", path("new"), "--overwrite"})));
  const auto before = contents_of(folder_);
  expect_failure(palpa_here(run({"--frames", "1", "--record", path("take"), "--overwrite", "--link", "nobody"})), 2,
                 "nobody");
  fs::create_directory(path("empty"));
  for (const char* name : {"never", "empty"})
    expect_failure(palpa_here(run({"--record", path(name), "--link", "foci:udp:nowhere"})), 2,
                   "link foci takes udp:HOST:PORT");
  fs::remove(path("empty"));  // which must be empty
  EXPECT_TRUE(contents_of(folder_) == before);
}

TEST_F(CliRecording, NeverReplacesWhatIsNotARecordingOrIsPlayed) {
  succeeded(palpa_here(run({"--frames", "3", "--every-frame", "--record", path("take")})));
  fs::create_symlink(path("take"), path("soft"));
  for (const char* source : {"take", "soft", "take/recording.toml", "soft/../take"}) {
    for (const char* target : {"take", "soft"})
      expect_untouched(replay({"--source", "recording:" + path(source), "--record", path(target), "--overwrite"}),
                       "is read by this command");
  }

  fs::create_directory(path("mine"));
  std::ofstream(path("mine/notes.txt")) << "mine";
  expect_untouched(run({"--frames", "1", "--record", path("mine"), "--overwrite"}), "which is not part of a recording");
  fs::copy_file(path("mine/notes.txt"), path("take/notes.txt"));
  expect_untouched(run({"--frames", "1", "--record", path("take"), "--overwrite"}), "which is not part of a recording");
  expect_untouched(run({"--frames", "1", "--overwrite"}), "--overwrite goes with --record");
}

}  // namespace
}  // namespace palpa::test
