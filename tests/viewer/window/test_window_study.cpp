// A study's two windows, on a private X server, in front of an emulated array; skipped if there is no Xvfb.
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "cli/support/live_run.hpp"
#include "driver/openmpd/emulation.hpp"
#include "geometry/files/ply.hpp"
#include "screen_test.hpp"
#include "session/links/sources.hpp"
#include "support/begins.hpp"
#include "support/files.hpp"
#include "support/shared_data.hpp"
#include "support/study_files.hpp"
#include "support/thrown.hpp"
#include "viewer/study/study_plan.hpp"

namespace palpa::test {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

/// Touches of 50 ms, on one OpenMPD board.
fs::path plan_in(const fs::path& folder, const std::string& blocks, const std::string& level = "limit_db = 140\n") {
  write_study_rig(folder);
  return write_study_plan(folder, blocks, {.layout = "openmpd", .run = "", .level = level});
}

std::vector<std::string> line(const fs::path& plan, const std::vector<std::string>& more = {}) {
  return with({"--study", plan.string(), "--participant", "1", "--out", (plan.parent_path() / "study").string(),
               "--rig", (plan.parent_path() / "rig.toml").string(), "--backend", "cpu", "--rehearse", "0.5", "--size",
               "400x300", "--hold", "2s"},
              more);
}

std::size_t entries_in(const fs::path& journal, const std::string& what) {
  if (!fs::exists(journal)) return 0;
  const std::string text = read_text(journal);
  std::size_t count = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1))
    ++count;
  return count;
}

/// The program in front of emulated boards.
class WindowStudy : public ScreenTest {
 protected:
  LiveOptions options() {
    LiveOptions options{.err = &*err_, .environment = on_screen(), .program = PALPA_VIEWER_BINARY};
    for (const auto& entry : boards_.environment())
      options.environment.push_back(entry);
    return options;
  }
  void begin(const fs::path& plan, const std::vector<std::string>& more = {}) {
    err_.emplace(Unread::file((folder_ / "said").string()));
    run_.emplace(line(plan, with({"--link", "openmpd:EMU1"}, more)), options());
  }
  /// Waits until a touch that does not end is under way and the boards sound.
  bool touches() {
    // It dips by 4 mm up and down, so it is in the object all the time.
    geometry::Mesh finger = session::load_skin(source_file("assets/finger.ply").string());
    for (Vec3& position : finger.positions)
      position.y -= 6e-3;
    const std::string pressed = (folder_ / "pressed.ply").string();
    geometry::write_ply(pressed, finger.positions, finger.triangles);
    const fs::path plan = plan_in(folder_, "[[block]]\nkind = \"trial\"\ntouch_s = 60\n");
    const std::vector<std::string> source{"--source", "synthetic:" + pressed};
    begin(plan, source);
    std::size_t before = heard_in(trace_).last_sounding;
    // The trace grows by some megabytes per second, so it is not read more often than necessary. A slow machine can end
    // a rehearsal, and the same command continues.
    return begins([&] { return entries_in(journal_, "\"begin\"") > 0; }) && begins([&] {
             const bool ended = run_->wait(0.5).ended;
             const std::size_t last = heard_in(trace_).last_sounding;
             if (ended) {
               before = last;
               begin(plan, source);
             }
             return last > before;
           });
  }
  LiveRun::End ends(double within_s = 20) {
    const LiveRun::End end = run_->wait(within_s);
    EXPECT_TRUE(end.ended);
    return end;
  }
  std::string said() const { return read_text(folder_ / "said"); }
  std::string log() const { return read_text(folder_ / "study/sub-01/beh/sub-01_task-shapes_run-01_events.tsv"); }
  void expect_silence() {
    boards_.end();
    const Heard heard = heard_in(trace_);
    EXPECT_GT(heard.last_sounding, 0u) << "it did sound";
    EXPECT_TRUE(heard.ends_silent());
  }

  const fs::path folder_ = scratch_folder("window-study"), trace_ = folder_ / "trace",
                 journal_ = folder_ / "study/sub-01/sub-01_journal.jsonl";
  Emulation boards_{"window-study-boards", "EMU1", {"--trace", trace_.string()}};
  std::optional<Unread> err_;
  std::optional<LiveRun> run_;
};

TEST_F(WindowStudy, AWholeStudyIsKilledTwiceAndHasTheSameAnalysis) {
  const fs::path plan = plan_in(folder_,
                                "[[block]]\nkind = \"familiarise\"\n[[block]]\nkind = \"practice\"\nshapes = "
                                "[\"cube\"]\nfeedback = true\n[[block]]\nkind = \"trial\"\n");
  const auto begun = [&] { return entries_in(journal_, "\"begin\""); };
  std::size_t starts = 0;
  int kills = 0;
  // A program that has stood still during a touch pauses, and the rehearsal then stops. A slow machine can cause that.
  // The same command continues, as after a kill.
  constexpr std::size_t most_starts = 40;
  while (entries_in(journal_, "\"finish\"") == 0 && starts < most_starts) {
    const std::size_t steps = begun() + 4;
    begin(plan);
    ++starts;
    LiveRun::End end;
    for (int i = 0; i < 6000 && !end.ended && (kills == 2 || begun() < steps); ++i)
      end = run_->wait(10e-3);
    if (end.ended) {
      const bool finished = entries_in(journal_, "\"finish\"") == 1;
      EXPECT_EQ(end.exit_code, finished ? 0 : 1) << said();
      EXPECT_TRUE(finished || said().find(": error: ") != std::string::npos) << "it says why";
      continue;
    }
    ASSERT_LT(kills, 2) << "the last run does not end: " << said();
    ASSERT_GE(begun(), steps) << said();
    run_->signal(SIGKILL);
    run_->wait(10);
    ++kills;
  }
  EXPECT_EQ(kills, 2);
  EXPECT_EQ(entries_in(journal_, "\"start\""), starts);
  EXPECT_EQ(entries_in(journal_, "\"finish\""), 1u);
  // The same participant without windows and kills.
  const Result whole = succeeded(palpa({"study", "rehearse", plan.string(), "--participant", "1", "--out",
                                        (folder_ / "whole").string(), "--accuracy", "0.5"}));
  EXPECT_EQ(answers_in(folder_ / "study"), answers_in(folder_ / "whole"));
  EXPECT_EQ(answers_in(folder_ / "whole").size(), 8u);
  boards_.end();
  EXPECT_TRUE(heard_in(trace_).ends_silent());
}

TEST_F(WindowStudy, ASignalDuringATouchIsSilenceAndAVoidTrial) {
  int times = 0;
  do {
    ASSERT_TRUE(touches()) << said();
    run_->signal(SIGTERM);
    EXPECT_EQ(ends(10).exit_code, 1) << said();
  } while (said().find(": error: the program stood still") != std::string::npos && ++times < 5);  // a slow machine
  EXPECT_CONTAINS(said(), "stopped by a signal after 0 of 8 steps; the same command continues");
  EXPECT_CONTAINS(log(), "\tvoid\t");
  expect_silence();
}

/// Nobody is there to press a key.
TEST_F(WindowStudy, ARehearsalThatPausesSaysWhy) {
  ASSERT_TRUE(touches()) << said();
  run_->signal(SIGSTOP);
  run_->wait(1.2);
  run_->signal(SIGCONT);
  EXPECT_EQ(ends().exit_code, 1) << said();
  // The reason depends on which of its threads runs again first.
  EXPECT_TRUE(said().find(": error: the program stood still") != std::string::npos ||
              said().find(": error: the array takes no drives") != std::string::npos)
      << said();
  expect_silence();
}

TEST_F(WindowStudy, ASignalSaysThatABoardThatHangsMaySound) {
  ASSERT_TRUE(touches()) << said();
  kill(boards_.id(), SIGSTOP);
  run_->wait(0.3);
  run_->signal(SIGTERM);
  EXPECT_EQ(ends(10).exit_code, 1) << said();
  EXPECT_CONTAINS(said(), ": it may still sound, switch it off\n");
  kill(boards_.id(), SIGCONT);
}

/// The viewer, with or without a window.
TEST(ViewerEnd, SaysThatABoardThatHangsMaySound) {
  const fs::path folder = scratch_folder("viewer-end");
  Emulation boards("viewer-end-boards", "EMU1", {"--trace", (folder / "trace").string()});
  write_text(folder / "script", "draw 2\nwait 100\n");
  const Unread err = Unread::file((folder / "said").string());
  LiveOptions options{.err = &err, .environment = boards.environment(), .program = PALPA_VIEWER_BINARY};
  options.environment.push_back(where_assets_are());
  LiveRun run({"--scene", source_file("assets/cube.glb").string(), "--source", "synthetic", "--link", "openmpd:EMU1",
               "--layout", "openmpd", "--backend", "cpu", "--hold", "5s", "--headless", "--size", "64x48", "--interact",
               (folder / "script").string(), "--ceiling", "0.5"},
              options);
  const auto said = [&] { return read_text(folder / "said"); };
  ASSERT_TRUE(begins([&] { return heard_in(folder / "trace").sounding > 0 || run.wait(0).ended; })) << said();
  kill(boards.id(), SIGSTOP);
  run.wait(0.3);
  run.signal(SIGTERM);
  EXPECT_EQ(run.wait(60).exit_code, 1) << said();
  EXPECT_CONTAINS(said(), ": it may still sound, switch it off\n");
  kill(boards.id(), SIGCONT);
}

TEST_F(WindowStudy, ClosingTheParticipantsWindowDuringATouchIsSilence) {
  ASSERT_TRUE(touches()) << said();
  XHand hand(server_->name());
  ASSERT_TRUE(hand.find("palpa participant", 60));
  EXPECT_GT(hand.picture().colours(), 20u) << "the marker and its text";
  XHand experimenter(server_->name());
  ASSERT_TRUE(experimenter.find("palpa experimenter", 60));
  EXPECT_TRUE(comes_to([&] { return experimenter.picture().has_red(); })) << "the lamp";
  hand.close();
  EXPECT_EQ(ends().exit_code, 0) << said();
  EXPECT_CONTAINS(log(), "\tvoid\t");
  expect_silence();
}

TEST_F(WindowStudy, ADisplayThatCrashesIsSilence) {
  ASSERT_TRUE(touches()) << said();
  server_->kill();
  EXPECT_NE(ends().exit_code, 0);
  expect_silence();
}

/// What the command line refuses, and in what words.
TEST(StudyLine, RefusesWhatCannotBeASitting) {
  const fs::path folder = scratch_folder("study-line");
  const std::string plan = plan_in(folder, "").string(), none = (folder / "none.toml").string();
  const RunOptions no_screen{{{"DISPLAY", ""}, {"WAYLAND_DISPLAY", ""}, where_assets_are()}};
  const std::vector<std::string> first{"--participant", "1"}, out{"--out", "x"};
  struct Case {
    std::vector<std::string> line;
    int code;
    std::string told;
  };
  for (const Case& one : std::vector<Case>{
           {with({"--study", plan}, out), 2, "--participant is missing"},
           {with({"--study", plan}, first), 2, "--out is missing"},
           {with(with({"--study", plan}, first), out), 2, "--source is missing"},
           {with(with(with({"--study", none}, first), out), {"--rehearse", "1"}), 4, "none.toml"},
           {line(plan, {"--link", "record:x"}), 2, "does not play into a file"},
           {line(plan), 3, "palpa study rehearse needs none"},
       }) {
    SCOPED_TRACE(one.told);
    expect_failure(run_program(PALPA_VIEWER_BINARY, one.line, no_screen), one.code, one.told);
  }
  // `palpa study run` passes on the line and the exit code.
  std::vector<std::string> same = line(plan);
  same.erase(same.begin(), same.begin() + 2);
  expect_failure(palpa(with({"study", "run", plan}, same), no_screen), 3, "palpa study rehearse needs none");
  EXPECT_FALSE(fs::exists(folder / "study")) << "nothing was begun";
  const Result help = run_program(PALPA_VIEWER_BINARY, {"--study", "--help"}, no_screen);
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_CONTAINS(help.out, "--participant");
}

TEST_F(WindowStudy, ALevelAboveTheLimitIsRefusedWithoutASignature) {
  const fs::path plan = plan_in(folder_, "", "ceiling = 1\nlimit_db = 100\n");
  expect_failure(run_program(PALPA_VIEWER_BINARY, line(plan), {on_screen()}), 2, "lower the ceiling of its [level]");
  EXPECT_FALSE(fs::exists(folder_ / "study")) << "nothing was begun";
}

}  // namespace
}  // namespace palpa::test
