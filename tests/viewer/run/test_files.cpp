// palpa-viewer and its scripts never write a file that they read, whatever its name is.
#include <gtest/gtest.h>

#include <filesystem>
#include <regex>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "cli/support/every_command.hpp"
#include "cli/support/process.hpp"
#include "cli/support/tiny_files.hpp"
#include "support/boards.hpp"
#include "support/files.hpp"
#include "support/shared_data.hpp"
#include "viewer_here.hpp"

namespace palpa {
namespace {

namespace fs = std::filesystem;

using test::with;
using test::write_text;

class ViewerFiles : public testing::Test {
 protected:
  ViewerFiles() {
    test::write_tiny_files(folder_);
    fs::copy_file(folder_ / "finger.ply", folder_ / "skin.ply");
    fs::copy_file(test::source_file("assets/rigs/paper.toml"), folder_ / "screen.toml");
    write_text(folder_ / "reference.png", "that is compared");
    write_text(folder_ / "old", "what was");
  }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  /// Another name of a file; tests/base has all kinds of them.
  std::string link_to(const std::string& file) const {
    fs::remove(path("soft"));
    fs::create_symlink(path(file), path("soft"));
    return path("soft");
  }
  /// Runs a test's first line with the program, and the others in this process.
  test::Result viewer(const std::vector<std::string>& words) {
    const std::vector<std::string> line = with(words, {"--headless", "--size", "64x48"});
    if (!std::exchange(first_, false)) return test::viewer_here(line);
    return test::run_program(PALPA_VIEWER_BINARY, line,
                             {{{"DISPLAY", ""}, {"WAYLAND_DISPLAY", ""}, test::where_assets_are()}});
  }
  /// Rejected, and all files are unchanged.
  void expect_refused(const std::vector<std::string>& words, const std::string& part, int code = 2) {
    SCOPED_TRACE(words[words.size() - 2] + " " + words.back());
    const auto before = test::contents_of(folder_);
    const test::Result result = viewer(words);
    EXPECT_EQ(result.exit_code, code) << result.err;
    EXPECT_NE(result.err.find(part), std::string::npos) << result.err;
    EXPECT_TRUE(test::contents_of(folder_) == before);
  }
  /// A script with these lines.
  std::string script(const std::string& lines) const {
    write_text(folder_ / "script", lines);
    return path("script");
  }

  fs::path folder_ = test::scratch_folder("viewer-files");
  bool first_ = true;
  const std::vector<std::string> live_{"--scene",        path("scene.gltf"), "--rig",
                                       path("rig.toml"), "--source",         "recording:" + path("take")};
  const std::string read_ = "is read by this command, name another file", same_ = "name the same file";
};

TEST_F(ViewerFiles, WhatAPictureIsMadeOfIsNotWritten) {
  script("draw\n");
  const std::vector<std::string> scene{"--scene", path("scene.gltf")};
  const std::vector<std::string> picture =
      with(scene, {"--points", path("finger.ply"), "--layout", path("layout.toml"), "--skin", path("skin.ply"),
                   "--reference", path("reference.png"), "--interact", path("script")});
  for (const std::string file : {"scene.gltf", "corners.bin", "picture.png", "finger.ply", "layout.toml", "skin.ply",
                                 "script", "reference.png"}) {
    for (const char* output : {"--screenshot", "--json"})
      expect_refused(with(picture, {output, link_to(file)}), read_);
  }
  const std::string screen = path("screen.toml"), depth = path("depth.png"), camera = path("camera.toml");
  expect_refused(with(scene, {"--participant", "--screen", screen, "--screenshot", screen}), read_);
  for (const std::string& file : {depth, camera})
    expect_refused(with(scene, {"--depth", depth, "--camera", camera, "--screenshot", file}), read_);
  expect_refused({"--sensation", path("script"), "--screenshot", link_to("script")}, read_);
  // A file that does not exist yet, compared with itself.
  expect_refused(with(scene, {"--reference", path("absent.png"), "--screenshot", link_to("absent.png")}), read_);
}

TEST_F(ViewerFiles, WhatALiveRunReadsIsNotWritten) {
  for (const std::string file : {"scene.gltf", "rig.toml"}) {
    for (const char* output : {"--screenshot", "--json", "--events"})
      expect_refused(with(live_, {output, link_to(file)}), read_);
    expect_refused(with(live_, {"--link", "record:" + link_to(file)}), read_);
  }
  for (const std::string file :
       {"corners.bin", "mask.png", "layout.toml", "take/recording.toml", "take/times.csv", "take/depth-0.png"})
    expect_refused(with(live_, {"--link", "record:" + path(file)}), read_);
  // The guard, another process, reads these. Only the program knows links to boards.
  fs::create_directories(folder_ / "boards");
  const std::string file = "boards/" + test::serial_board_file();
  write_text(folder_ / file, "0\n");
  for (const char* output : {"--screenshot", "--json", "--events"}) {
    first_ = true;
    expect_refused(with(live_, {"--link", "openmpd", "--board-files", path("boards"), output, path(file)}), read_);
  }
}

TEST_F(ViewerFiles, AShotIsNoFileThatIsRead) {
  const std::vector<std::string> touch{"--scene", path("scene.gltf"), "--points",    path("finger.ply"), "--backend",
                                       "cpu",     "--interact",       path("script")};
  script("draw\n");
  for (const std::string file : {"finger.ply", "corners.bin", "picture.png", "script", "scene.gltf"}) {
    script("draw\nshot " + link_to(file) + "\ndraw\n");
    expect_refused(touch, "shot in line 2 of --interact");
  }
  for (const std::string file : {"new.png", "old"}) {
    const std::string name = link_to(file);
    script("draw\nshot " + path(file) + "\nshot " + name + "\n");
    expect_refused(touch, same_);
    script("draw\nshot " + path(file) + "\n");
    for (const char* output : {"--json", "--screenshot"})
      expect_refused(with(touch, {output, name}), same_);
  }
  // Files of a live run, which are read while the script is played, and dropped files.
  for (const std::string file : {"mask.png", "corners.bin", "layout.toml", "take/depth-0.png"}) {
    script("draw\nshot " + path(file) + "\ndraw\n");
    expect_refused(with(live_, {"--backend", "cpu", "--interact", path("script")}), read_);
  }
  test::write_scene(folder_ / "second.gltf", "dropped.bin");
  test::write_tetrahedron(folder_ / "dropped.bin");
  script("draw\ndrop " + path("second.gltf") + "\nshot " + path("dropped.bin") + "\ndraw\n");
  expect_refused(touch, "is read by this command");
  // A file that nothing reads may be overwritten any number of times.
  script("draw\nshot " + path("new.png") + "\ndraw\nshot " + path("new.png") + "\n");
  first_ = true;
  succeeded(viewer(touch));
  succeeded(viewer(touch));
}

TEST_F(ViewerFiles, WhatAModelOrARecordingNamesIsInItsFolder) {
  write_text(folder_ / "short.bin", "Q7");
  fs::create_directory(folder_ / "theirs");
  test::write_scene(folder_ / "theirs/model.gltf", "../short.bin");
  test::write_recording(folder_ / "theirs/recording.toml", "files = [\"../depth-%d.png\"]\n");
  const std::vector<std::string> model{"--scene", path("theirs/model.gltf")};
  expect_refused(model, "--allow-outside", 4);
  expect_refused(with(model, {"--allow-outside"}), "has 2 bytes", 4);
  expect_refused(
      {"--scene", path("scene.gltf"), "--layout", path("layout.toml"), "--source", "recording:" + path("theirs")},
      "--allow-outside", 4);
}

TEST_F(ViewerFiles, TheViewersSettingsAreNotWritten) {
  fs::create_directories(folder_ / "palpa");
  write_text(folder_ / "palpa/viewer.toml", "dark = true\n");
  setenv("XDG_CONFIG_HOME", folder_.c_str(), 1);
  for (const char* output : {"--json", "--screenshot"})
    expect_refused({"--scene", path("scene.gltf"), output, link_to("palpa/viewer.toml")}, "is a file of palpa's own");
  unsetenv("XDG_CONFIG_HOME");
}

TEST_F(ViewerFiles, NoFileIsWrittenTwice) {
  for (const std::string file : {"new", "old"}) {
    const std::string name = link_to(file);
    expect_refused({"--scene", path("scene.gltf"), "--json", path(file), "--screenshot", name}, same_);
    expect_refused({"--scene", path("scene.gltf"), "--source", "recording:" + path("take"), "--events", path(file),
                    "--screenshot", name},
                   same_);
  }
  expect_refused({"--scene", path("scene.gltf"), "--video", path("film"), "--screenshot", path("film")}, same_);
  expect_refused({"--scene", path("scene.gltf"), "--source", "recording:" + path("take"), "--video", path("film"),
                  "--record", path("film/")},
                 same_);
  fs::create_directory(folder_ / "film");
  expect_refused({"--scene", path("scene.gltf"), "--video", path("film"), "--screenshot", path("film/1.png")},
                 "one lies in the folder of the other");
}

TEST_F(ViewerFiles, EveryOptionThatNamesAFileIsTried) {
  // A new option that names a file must be tried above.
  const std::set<std::string> inputs{"--scene",    "--points",      "--depth",    "--camera", "--rig",
                                     "--layout",   "--source",      "--skin",     "--screen", "--reference",
                                     "--interact", "--board-files", "--sensation"},
      outputs{"--json", "--screenshot", "--video", "--events", "--link", "--record"};
  std::size_t found = 0;
  for (const test::HelpedOption& option : test::options_in(test::viewer({"--help", "all"}).out)) {
    static const std::regex of_files("(^|[^A-Z])(FILE|FOLDER|DIR|LINK|SOURCE)($|[^A-Z])");
    if (!std::regex_search(option.type, of_files)) continue;
    EXPECT_TRUE(inputs.contains(option.name) || outputs.contains(option.name)) << option.name;
    ++found;
  }
  EXPECT_EQ(found, inputs.size() + outputs.size());
}

}  // namespace
}  // namespace palpa
