// Signals at unusual moments, to a loop that plays to an emulated board: the last bytes on the board's wire, and the
// processes that are left.
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "cli/support/live_run.hpp"
#include "cli/support/process.hpp"
#include "driver/openmpd/emulation.hpp"
#include "support/begins.hpp"
#include "support/files.hpp"
#include "support/instrumented.hpp"
#include "support/shared_data.hpp"
#include "support/side_by_side.hpp"

namespace palpa::test {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;

/// The second that palpa promises, and as much again for the system; more in instrumented builds.
constexpr double most_s = instrumented() ? 6 : 2;

/// An emulated board, and loops that play to it.
class Stage {
 public:
  explicit Stage(const std::string& name) : folder_(scratch_folder(name)), board_(name + "-b", "EMU1", traced()) {}

  const fs::path& folder() const { return folder_; }
  Heard heard() const { return heard_in(folder_ / "wire"); }
  LiveOptions options(const char* command) const {
    LiveOptions options;
    options.environment = board_.environment();
    options.command = command;
    return options;
  }
  /// A loop that lasts.
  LiveRun loop() const {
    return LiveRun({"test", "--layout", "openmpd", "--link", "openmpd:EMU1", "--each", "100s"}, options("link"));
  }
  /// The guards of its loops that have not ended.
  std::vector<pid_t> guards() const {
    const std::string mark = "XDG_RUNTIME_DIR=" + board_.folder().string();
    std::vector<pid_t> found;
    std::error_code gone;
    for (const auto& entry : fs::directory_iterator("/proc", gone)) {
      const std::string name = entry.path().filename();
      if (name.find_first_not_of("0123456789") != std::string::npos) continue;
      if (read_text(entry.path() / "comm") != "palpa-guard\n") continue;
      const std::string environment = '\0' + read_text(entry.path() / "environ");
      if (environment.find('\0' + mark + '\0') != std::string::npos) found.push_back(std::stoi(name));
    }
    return found;
  }
  /// After a loop has ended: its guard goes, and the last frame that the board got is silence.
  void expect_silent_and_alone() const {
    EXPECT_TRUE(begins([&] { return guards().empty(); })) << "its guard is left";
    EXPECT_TRUE(begins([&] { return heard().ends_silent(); })) << "the board sounds";
    // On a busy machine, the board reads the last bytes a moment after the guard that wrote them has ended. Whatever it
    // reads then must be silence, and must come to an end.
    const Heard before = heard();
    const auto nothing_comes = [&] {
      const std::size_t bytes = heard().bytes;
      std::this_thread::sleep_for(150ms);  // longer than a guard waits for a drive
      return heard().bytes == bytes;
    };
    EXPECT_TRUE(begins(nothing_comes)) << "something still comes";
    const Heard after = heard();
    EXPECT_TRUE(after.ends_silent()) << "the board sounds";
    EXPECT_EQ(after.last_sounding, before.last_sounding) << "a sounding frame came late";
  }
  ~Stage() {
    const nlohmann::json report = board_.end();
    EXPECT_FALSE(report["boards"][0]["sounds"].get<bool>()) << report;
  }
  Stage(const Stage&) = delete;
  Stage& operator=(const Stage&) = delete;

 private:
  std::vector<std::string> traced() const { return {"--trace", (folder_ / "wire").string()}; }

  fs::path folder_;
  Emulation board_;
};

/// Waits until a loop's board sounds that had heard this before.
testing::AssertionResult sounds_on(const Stage& stage, const Heard& before = {}) {
  if (begins([&] { return stage.heard().last_sounding > before.frames; })) return testing::AssertionSuccess();
  return testing::AssertionFailure() << "nothing sounds";
}

TEST(CliSignals, DuringTheStartLeaveNothingThatSounds) {
  const auto ends = [](std::chrono::milliseconds after) {
    SCOPED_TRACE(after.count());
    const Stage stage("start-" + std::to_string(after.count()));
    for (const int signal : {SIGTERM, SIGINT, SIGKILL}) {
      LiveRun loop = stage.loop();
      std::this_thread::sleep_for(after);
      loop.signal(signal);
      const LiveRun::End end = loop.wait(60);
      ASSERT_TRUE(end.ended) << strsignal(signal);
      EXPECT_LT(end.after_s, most_s) << strsignal(signal);
      EXPECT_TRUE(end.by_signal == signal || end.exit_code == 0 || end.exit_code == 1)
          << end.by_signal << ' ' << end.exit_code;
      stage.expect_silent_and_alone();
    }
  };
  side_by_side(4, std::vector<std::chrono::milliseconds>{0ms, 5ms, 15ms, 40ms, 100ms, 300ms, 700ms, 1100ms}, ends);
}

TEST(CliSignals, ASecondOneAroundTheEndChangesNothing) {
  const auto ends = [](std::chrono::milliseconds between) {
    SCOPED_TRACE(between.count());
    const Stage stage("twice-" + std::to_string(between.count()));
    for (const auto& [first, second] : {std::pair(SIGTERM, SIGINT), std::pair(SIGINT, SIGHUP)}) {
      const Heard before = stage.heard();
      LiveRun loop = stage.loop();
      ASSERT_TRUE(sounds_on(stage, before));
      loop.signal(first);
      std::this_thread::sleep_for(between);
      loop.signal(second);
      const LiveRun::End end = loop.wait(60);
      ASSERT_TRUE(end.ended);
      EXPECT_LT(end.after_s, most_s);
      // When everything is over, a signal may end the program as it ends any other.
      EXPECT_TRUE(end.by_signal == 0 || end.by_signal == second) << end.by_signal;
      stage.expect_silent_and_alone();
    }
  };
  side_by_side(4, std::vector<std::chrono::milliseconds>{0ms, 2ms, 10ms, 50ms}, ends);
}

TEST(CliSignals, ALoopThatIsKilledLeavesNoGuard) {
  const Stage stage("orphan");
  for (int times = 0; times < 2; ++times) {
    const Heard before = stage.heard();
    LiveRun loop = stage.loop();
    ASSERT_TRUE(sounds_on(stage, before));
    EXPECT_EQ(stage.guards().size(), 1u);
    loop.signal(SIGKILL);
    EXPECT_EQ(loop.wait(60).by_signal, SIGKILL);
    stage.expect_silent_and_alone();
  }
}

}  // namespace
}  // namespace palpa::test
