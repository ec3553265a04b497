// A study's two windows, on a private X server, in front of an emulated array; skipped if there is no Xvfb.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "cli/support/live_run.hpp"
#include "cli/support/process.hpp"
#include "driver/openmpd/emulation.hpp"
#include "geometry/files/ply.hpp"
#include "session/links/sources.hpp"
#include "study/files/study_folder.hpp"
#include "support/files.hpp"
#include "support/shared_data.hpp"
#include "support/study_files.hpp"
#include "viewer/render/drawing_test.hpp"
#include "x_display.hpp"

namespace palpa::test {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using WindowStudy = DrawingTest;

/// Two shapes, two methods, touches of 50 ms, on one OpenMPD board.
fs::path plan_in(const fs::path& folder, const std::string& blocks, const std::string& level = "limit_db = 140") {
  const std::string assets = source_file("assets").string();
  write_text(folder / "plan.toml", "title = \"Two\"\n[[shape]]\nname = \"cube\"\nmodel = \"" + assets +
                                       "/cube.glb\"\n[[shape]]\nname = \"pyramid\"\nmodel = \"" + assets +
                                       "/pyramid.glb\"\n[[method]]\nname = \"single-focus\"\nlayout = \"openmpd\"\n"
                                       "[[method]]\nname = \"cross-section\"\nlayout = \"openmpd\"\n"
                                       "[study]\nparticipants = 2\ntrials_per_shape = 2\ntouch_s = 0.05\n"
                                       "[run]\nmasking = \"off\"\n[level]\n" +
                                       level + "\n" + blocks);
  write_study_rig(folder);
  return folder / "plan.toml";
}

std::vector<std::string> line(const fs::path& plan, const std::vector<std::string>& more = {}) {
  return with({"--study", plan.string(), "--participant", "1", "--out", (plan.parent_path() / "study").string(),
               "--rig", (plan.parent_path() / "rig.toml").string(), "--backend", "cpu", "--rehearse", "0.5", "--size",
               "400x300", "--hold", "2s"},
              more);
}

Environment in(const std::string& display) {
  return {{"DISPLAY", display}, {"WAYLAND_DISPLAY", ""}, {"XDG_CONFIG_HOME", "/dev/null"}, where_assets_are()};
}

std::vector<std::array<std::uint32_t, 3>> answers_in(const fs::path& folder) {
  const study::Study study = study::read_study(std::vector<std::string>{folder.string()});
  std::vector<std::array<std::uint32_t, 3>> rows;
  if (study.participants.empty()) return rows;
  for (const study::Trial& trial : study.participants[0].trials)
    rows.push_back({trial.method, trial.shape, trial.answer});
  std::ranges::sort(rows);
  return rows;
}

std::size_t entries_in(const fs::path& journal, const std::string& what) {
  if (!fs::exists(journal)) return 0;
  const std::string text = read_text(journal);
  std::size_t count = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1))
    ++count;
  return count;
}

constexpr const char* blocks =
    "[[block]]\nkind = \"familiarise\"\n[[block]]\nkind = \"practice\"\nshapes = "
    "[\"cube\"]\nfeedback = true\n[[block]]\nkind = \"trial\"\n";

TEST_F(WindowStudy, AWholeStudyIsKilledTwiceAndHasTheSameAnalysis) {
  const XServer server;
  if (server.name().empty()) GTEST_SKIP() << "skipped: no Xvfb";
  const fs::path folder = scratch_folder("window-study");
  const fs::path plan = plan_in(folder, blocks);
  Emulation boards("window-study-boards", "EMU1", {"--trace", (folder / "trace").string()});
  LiveOptions options;
  options.environment = in(server.name());
  for (const auto& entry : boards.environment())
    options.environment.push_back(entry);
  options.program = PALPA_VIEWER_BINARY;
  const std::string said = (folder / "said").string();
  const fs::path journal = folder / "study/sub-01/sub-01_journal.jsonl";
  std::size_t starts = 0;
  int kills = 0;
  // A program that has stood still during a touch pauses, and the rehearsal then stops. A slow machine can cause that.
  // The same command continues, as after a kill.
  constexpr std::size_t most_starts = 40;
  while (entries_in(journal, "\"finish\"") == 0 && starts < most_starts) {
    const Unread err = Unread::file(said);
    options.err = &err;
    const std::size_t steps = entries_in(journal, "\"begin\"") + 4;
    LiveRun run(line(plan, {"--link", "openmpd:EMU1"}), options);
    ++starts;
    LiveRun::End end;
    for (int i = 0; i < 6000 && !end.ended && (kills == 2 || entries_in(journal, "\"begin\"") < steps); ++i)
      end = run.wait(10e-3);
    if (end.ended) {
      const bool finished = entries_in(journal, "\"finish\"") == 1;
      EXPECT_EQ(end.exit_code, finished ? 0 : 1) << read_text(said);
      EXPECT_TRUE(finished || read_text(said).find(": error: ") != std::string::npos) << "it says why";
      continue;
    }
    ASSERT_LT(kills, 2) << "the last run does not end: " << read_text(said);
    ASSERT_GE(entries_in(journal, "\"begin\""), steps) << read_text(said);
    run.signal(SIGKILL);
    run.wait(10);
    ++kills;
  }
  EXPECT_EQ(kills, 2);
  EXPECT_EQ(entries_in(journal, "\"start\""), starts);
  EXPECT_EQ(entries_in(journal, "\"finish\""), 1u);
  // The same participant without windows and kills.
  const Result whole = palpa({"study", "rehearse", plan.string(), "--participant", "1", "--out",
                              (folder / "whole").string(), "--accuracy", "0.5"});
  EXPECT_EQ(whole.exit_code, 0) << whole.err;
  EXPECT_EQ(answers_in(folder / "study"), answers_in(folder / "whole"));
  EXPECT_EQ(answers_in(folder / "whole").size(), 8u);
  int exit_code = -1;
  boards.end(exit_code);
  EXPECT_EQ(exit_code, 0);
  EXPECT_TRUE(heard_in(folder / "trace").ends_silent());
}

/// A study whose touch does not end, and the boards that hear it.
class SoundingStudy {
 public:
  explicit SoundingStudy(const std::string& name, const XServer& server)
      : folder_(scratch_folder(name)),
        boards_(name + "-boards", "EMU1", {"--trace", (folder_ / "trace").string()}),
        err_(Unread::file((folder_ / "said").string())) {
    const fs::path plan = plan_in(folder_, "[[block]]\nkind = \"trial\"\ntouch_s = 60\n");
    LiveOptions options;
    options.environment = in(server.name());
    for (const auto& entry : boards_.environment())
      options.environment.push_back(entry);
    options.err = &err_;
    options.program = PALPA_VIEWER_BINARY;
    // It dips by 4 mm up and down, so it is in the object all the time.
    geometry::Mesh finger = session::load_skin(source_file("assets/finger.ply").string());
    for (Vec3& position : finger.positions)
      position.y -= 6e-3;
    const std::string pressed = (folder_ / "pressed.ply").string();
    geometry::write_ply(pressed, finger.positions, finger.triangles);
    run_.emplace(line(plan, {"--link", "openmpd:EMU1", "--source", "synthetic:" + pressed}), options);
  }
  /// Waits until a touch is under way and the boards sound.
  bool touches() {
    const fs::path journal = folder_ / "study/sub-01/sub-01_journal.jsonl";
    for (int i = 0; i < 6000 && entries_in(journal, "\"begin\"") == 0; ++i)
      std::this_thread::sleep_for(10ms);
    // The trace grows by some megabytes per second, so it is not read more often.
    for (int i = 0; i < 60 && heard_in(folder_ / "trace").last_sounding == 0; ++i)
      std::this_thread::sleep_for(500ms);
    return entries_in(journal, "\"begin\"") > 0;
  }
  LiveRun& run() { return *run_; }
  std::string said() const { return read_text(folder_ / "said"); }
  std::string log() const { return read_text(folder_ / "study/sub-01/beh/sub-01_task-shapes_run-01_events.tsv"); }
  void expect_silence() {
    int exit_code = -1;
    boards_.end(exit_code);
    const Heard heard = heard_in(folder_ / "trace");
    EXPECT_GT(heard.last_sounding, 0u) << "it did sound";
    EXPECT_TRUE(heard.ends_silent());
  }

 private:
  fs::path folder_;
  Emulation boards_;
  Unread err_;
  std::optional<LiveRun> run_;
};

TEST_F(WindowStudy, ASignalDuringATouchIsSilenceAndAVoidTrial) {
  const XServer server;
  if (server.name().empty()) GTEST_SKIP() << "skipped: no Xvfb";
  SoundingStudy study("window-study-signal", server);
  ASSERT_TRUE(study.touches()) << study.said();
  study.run().signal(SIGTERM);
  const LiveRun::End end = study.run().wait(10);
  EXPECT_TRUE(end.ended);
  EXPECT_EQ(end.exit_code, 1) << study.said();
  EXPECT_NE(study.said().find("stopped by a signal after 0 of 8 steps; the same command continues"), std::string::npos)
      << study.said();
  EXPECT_NE(study.log().find("\tvoid\t"), std::string::npos) << study.log();
  study.expect_silence();
}

/// Nobody is there to press a key.
TEST_F(WindowStudy, ARehearsalThatPausesSaysWhy) {
  const XServer server;
  if (server.name().empty()) GTEST_SKIP() << "skipped: no Xvfb";
  SoundingStudy study("window-study-pause", server);
  ASSERT_TRUE(study.touches()) << study.said();
  study.run().signal(SIGSTOP);
  std::this_thread::sleep_for(1200ms);
  study.run().signal(SIGCONT);
  const LiveRun::End end = study.run().wait(20);
  EXPECT_TRUE(end.ended);
  EXPECT_EQ(end.exit_code, 1) << study.said();
  // The reason depends on which of its threads runs again first.
  const std::string said = study.said();
  EXPECT_TRUE(said.find(": error: the program stood still") != std::string::npos ||
              said.find(": error: the array takes no drives") != std::string::npos)
      << said;
  study.expect_silence();
}

TEST_F(WindowStudy, ClosingTheParticipantsWindowDuringATouchIsSilence) {
  const XServer server;
  if (server.name().empty()) GTEST_SKIP() << "skipped: no Xvfb";
  SoundingStudy study("window-study-closed", server);
  XHand hand(server.name());
  ASSERT_TRUE(hand.find("palpa participant", 60));
  ASSERT_TRUE(study.touches()) << study.said();
  EXPECT_GT(hand.picture().colours(), 20u) << "the marker and its text";
  hand.close();
  const LiveRun::End end = study.run().wait(20);
  EXPECT_TRUE(end.ended);
  EXPECT_EQ(end.exit_code, 0) << study.said();
  EXPECT_NE(study.log().find("\tvoid\t"), std::string::npos);
  study.expect_silence();
}

TEST_F(WindowStudy, ADisplayThatCrashesIsSilence) {
  XServer server;
  if (server.name().empty()) GTEST_SKIP() << "skipped: no Xvfb";
  SoundingStudy study("window-study-crash", server);
  ASSERT_TRUE(study.touches()) << study.said();
  server.kill();
  const LiveRun::End end = study.run().wait(20);
  EXPECT_TRUE(end.ended);
  EXPECT_NE(end.exit_code, 0);
  study.expect_silence();
}

/// What the command line refuses, and in what words.
TEST(StudyLine, RefusesWhatCannotBeASitting) {
  const fs::path folder = scratch_folder("study-line");
  const fs::path plan = plan_in(folder, "", "ceiling = 1\nlimit_db = 90");
  const auto viewer = [&](std::vector<std::string> arguments) {
    return run_program(PALPA_VIEWER_BINARY, arguments, {in("")});
  };
  expect_failure(viewer({"--study", plan.string(), "--out", "x"}), 2, "--participant is missing");
  expect_failure(viewer({"--study", plan.string(), "--participant", "1"}), 2, "--out is missing");
  expect_failure(viewer({"--study", plan.string(), "--participant", "1", "--out", "x"}), 2, "--source is missing");
  expect_failure(
      viewer({"--study", (folder / "none.toml").string(), "--participant", "1", "--out", "x", "--rehearse", "1"}), 4,
      "none.toml");
  expect_failure(viewer(line(plan, {"--link", "record:x"})), 2, "does not play into a file");
  expect_failure(viewer(line(plan)), 3, "palpa study rehearse needs none");
  EXPECT_FALSE(fs::exists(folder / "study")) << "nothing was begun";
  // `palpa study run` passes on the line and the exit code.
  std::vector<std::string> same = line(plan);
  same.erase(same.begin(), same.begin() + 2);
  const Result run = palpa(with({"study", "run", plan.string()}, same), {in("")});
  expect_failure(run, 3, "palpa study rehearse needs none");
  const Result help = viewer({"--study", "--help"});
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_NE(help.out.find("--participant"), std::string::npos);
}

TEST_F(WindowStudy, ALevelAboveTheLimitIsRefusedWithoutASignature) {
  const XServer server;
  if (server.name().empty()) GTEST_SKIP() << "skipped: no Xvfb";
  const fs::path folder = scratch_folder("study-loud");
  const fs::path plan = plan_in(folder, "", "ceiling = 1\nlimit_db = 90");
  expect_failure(run_program(PALPA_VIEWER_BINARY, line(plan), {in(server.name())}), 2,
                 "lower the ceiling of its [level]");
  EXPECT_FALSE(fs::exists(folder / "study")) << "nothing was begun";
}

}  // namespace
}  // namespace palpa::test
