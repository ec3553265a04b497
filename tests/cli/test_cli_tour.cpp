// Every line of the README's tour, in its order, as a new user types it: in one folder, with the assets in it. A line
// runs as it stands, or its comment says what it needs.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "cli/support/process.hpp"
#include "cli/support/terminal.hpp"
#include "support/instrumented.hpp"
#include "support/pseudo_terminal.hpp"
#include "support/shared_data.hpp"

namespace palpa::test {
namespace {

namespace fs = std::filesystem;

struct Line {
  std::string command;  ///< without its comment
  std::string comment;
  bool says(const std::string& part) const { return comment.find(part) != std::string::npos; }
  bool starts(const std::string& part) const { return command.starts_with(part); }
};

/// The lines of the section that begin with a program of palpa's.
std::vector<Line> tour() {
  std::ifstream readme(source_file("README.md"));
  std::vector<Line> lines;
  bool inside = false;
  for (std::string text; std::getline(readme, text);) {
    if (text.starts_with("## ")) inside = text == "## A tour";
    if (!inside || !text.starts_with("    palpa")) continue;
    const std::size_t hash = text.find(" #");
    Line line{text.substr(4, hash == std::string::npos ? hash : hash - 4),
              hash == std::string::npos ? "" : text.substr(hash)};
    line.command.erase(line.command.find_last_not_of(' ') + 1);
    lines.push_back(line);
  }
  return lines;
}

class CliTour : public testing::Test {
 protected:
  CliTour() { fs::create_directory_symlink(source_file("assets"), folder_ / "assets"); }

  bool has_viewer() const { return fs::exists(programs_ / "palpa-viewer"); }
  /// For a shell: the line in the folder, with the programs on the path, on the backend that palpa chooses.
  std::string in_folder(const std::string& line) const {
    const auto [name, assets] = where_assets_are();
    return "cd '" + folder_.string() + "' && unset PALPA_BACKEND && export PATH='" + programs_.string() +
           "':$PATH XDG_RUNTIME_DIR='" + folder_.string() + "' " + name + "='" + assets + "' && exec " + line;
  }
  Result run(const std::string& line) const { return run_program("/bin/sh", {"-c", in_folder(line)}); }

  fs::path folder_ = scratch_folder("tour"), programs_ = fs::path(palpa_binary()).parent_path();
};

TEST_F(CliTour, EveryLineRunsOrSaysWhatItNeeds) {
  if (instrumented()) GTEST_SKIP() << "skipped: the same programs, some thirty times as slow";
  PALPA_TERMINAL_OR_SKIP();
  std::size_t ran = 0, needing = 0;
  std::unique_ptr<Terminal> emulator;
  for (const Line& line : tour()) {
    SCOPED_TRACE(line.command);
    if (line.starts("palpa-viewer")) {
      if (!has_viewer()) continue;
      // As the README says, where there is no display.
      succeeded(run("env -u DISPLAY -u WAYLAND_DISPLAY " + line.command + " --headless --screenshot touch.png"));
      EXPECT_TRUE(fs::exists(folder_ / "touch.png"));
    } else if (line.says("# needs ")) {
      // Without what it needs, the error is about that, and not about the line.
      const Result result = run(line.command);
      EXPECT_TRUE(result.exit_code == 0 || result.exit_code == 1 || result.exit_code == 4) << result.err;
      EXPECT_LE(result.err_lines().size(), 1u) << result.err;
      ++needing;
      continue;
    } else if (line.says("# until Ctrl-C")) {
      auto terminal = std::make_unique<Terminal>("/bin/sh", std::vector<std::string>{"-c", in_folder(line.command)});
      if (line.starts("palpa emulate")) {
        ASSERT_TRUE(terminal->shows("silence")) << terminal->text();
        emulator = std::move(terminal);  // for the line after it
      } else if (line.command.ends_with("--events -")) {
        EXPECT_TRUE(terminal->shows("\"event\":\"press\"")) << terminal->text();
        terminal->type("\x03");
        EXPECT_EQ(terminal->ended_by_signal(), 0);
        EXPECT_EQ(terminal->text().find("Ctrl-C stops"), std::string::npos) << "a line between the events";
        EXPECT_TRUE(terminal->cut_short() || terminal->text().find("palpa: error") == std::string::npos)
            << terminal->text();
      } else {
        EXPECT_TRUE(terminal->shows("SOUNDING on ")) << terminal->text();
        EXPECT_TRUE(terminal->shows("Ctrl-C stops")) << terminal->text();
        terminal->type("\x03");
        EXPECT_EQ(terminal->ended_by_signal(), 0);
        if (!terminal->cut_short()) {
          EXPECT_NE(terminal->text().find("frame to drives: median"), std::string::npos) << terminal->text();
          EXPECT_LT(terminal->text().rfind("Ctrl-C stops"), terminal->text().rfind("\r\x1b[K")) << "the line is left";
          EXPECT_EQ(terminal->text().find("palpa: error"), std::string::npos) << terminal->text();
        }
      }
    } else {
      const Result result = succeeded(run(line.command));
      EXPECT_NE(result.out, "");
      EXPECT_EQ(result.err.find("palpa: error"), std::string::npos) << result.err;
    }
    ++ran;
  }
  ASSERT_TRUE(emulator);
  emulator->type("\x03");
  EXPECT_EQ(emulator->ended_by_signal(), 0);
  EXPECT_GE(ran, 14u);
  EXPECT_EQ(needing, 3u);
  for (const char* file : {"take1/recording.toml", "foci.csv", "drive.csv", "field.png", "pressure.png"})
    EXPECT_TRUE(fs::exists(folder_ / file)) << file;
}

TEST_F(CliTour, TheDepthImageAndTheRecordingShowATouch) {
  const Result touch = succeeded(
      palpa({"touch", "--scene", source_file("assets/cube.glb"), "--depth", source_file("assets/depth/hand.png"),
             "--camera", source_file("assets/depth/camera.toml"), "--backend", "cpu"}));
  EXPECT_NE(touch.out.find(" contacts, 1 finger ("), std::string::npos) << touch.out;
  const Result run =
      succeeded(palpa({"run", "--scene", source_file("assets/cube.glb"), "--source",
                       "recording:" + source_file("assets/depth/take").string(), "--every-frame", "--backend", "cpu"}));
  EXPECT_TRUE(run.out.starts_with("12 frames, 8 with a touch")) << run.out;
}

}  // namespace
}  // namespace palpa::test
