// Files from other people. Missing files, folders, pipes, devices and noise for every option that takes a file: exit
// code 4 and one line that names the file. Scenes and recordings: their references stay in their folders, and no
// message shows the contents of other files. What is wrong within a file is shown by the tests of its reader.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "cli/support/here.hpp"
#include "cli/support/process.hpp"
#include "cli/support/tiny_files.hpp"
#include "cli/support/told.hpp"
#include "geometry/gltf/write.hpp"
#include "support/boards.hpp"
#include "support/files.hpp"
#include "support/instrumented.hpp"
#include "support/shapes.hpp"
#include "support/shared_data.hpp"
#include "support/time_limits.hpp"

namespace palpa::test {
namespace {

namespace fs = std::filesystem;
using Lines = std::vector<std::vector<std::string>>;

class BadFiles : public testing::Test {
 protected:
  BadFiles() { write_text(camera_, tiny_camera); }

  /// `file` as the value of every option that reads one, all else being good.
  Lines lines_with(const std::string& file) const {
    return {{"touch", "--scene", file, "--points", finger_},
            {"touch", "--scene", cube_, "--points", file},
            {"touch", "--scene", cube_, "--depth", file, "--camera", camera_},
            {"touch", "--scene", cube_, "--depth", cube_, "--camera", file},
            {"touch", "--scene", cube_, "--depth", cube_, "--rig", file},
            {"drive", "--layout", file, "--focus", "0,0,0.1"}};
  }
  /// By the program, within a second and a gigabyte.
  static void expect_refused_soon(const std::vector<std::string>& line, const std::string& file) {
    SCOPED_TRACE(testing::PrintToString(line));
    RunOptions options;
    options.timeout_s = 30;
    const Result result = palpa(line, options);
    expect_failure(result, 4, file);
    // Sanitizers make everything slower and fatter.
    EXPECT_LT(result.processor_s, instrumented() ? 20 : slowest);
    if (!instrumented()) {
      EXPECT_LT(result.peak_mib, 1024);
    }
  }

  const fs::path folder_ = scratch_folder("bad-files");
  const std::string cube_ = source_file("assets/cube.glb"), finger_ = source_file("assets/finger.ply"),
                    camera_ = folder_ / "camera.toml";
};

TEST_F(BadFiles, AreRefusedByEveryOption) {
  write_text(folder_ / "empty", "");
  write_text(folder_ / "secret", "secret");
  fs::permissions(folder_ / "secret", fs::perms::none);
  std::string bytes;
  std::uint32_t state = 1;
  for (int i = 0; i < 100000; ++i)
    bytes += static_cast<char>((state = state * 1664525u + 1013904223u) >> 24);
  write_text(folder_ / "random", bytes);
  ASSERT_EQ(mkfifo((folder_ / "pipe").c_str(), 0600), 0);
  for (const fs::path& file : {folder_ / "not there.glb", folder_, folder_ / "empty", folder_ / "secret",
                               folder_ / "random", folder_ / "pipe", fs::path("/dev/zero")}) {
    for (const std::vector<std::string>& line : lines_with(file))
      expect_refused(line, {{{}, file, 4}});
  }
}

TEST_F(BadFiles, TenGigabytesAreRefusedAtOnce) {
  for (const char* name : {"zeros", "zeros.glb", "zeros.gltf"}) {
    write_text(folder_ / name, "");
    std::error_code error;
    fs::resize_file(folder_ / name, std::uintmax_t{10} << 30, error);
    if (error) GTEST_SKIP() << "skipped: no sparse files here: " << error.message();
  }
  Lines lines = lines_with(folder_ / "zeros");
  for (const char* name : {"zeros.glb", "zeros.gltf"})
    lines.push_back(lines_with(folder_ / name)[0]);
  for (const std::vector<std::string>& line : lines)
    expect_refused_soon(line, folder_ / "zeros");
}

TEST_F(BadFiles, OfTheBenchAreRefusedBeforeItMeasures) {
  expect_refused_soon({"bench", "--suite", "surface", "--scene", folder_ / "none.glb"}, folder_ / "none.glb");
  geometry::SceneMesh open{"open", box({0, 0, 0}, {1, 1, 1})};
  open.mesh.triangles.pop_back();
  geometry::write_glb(folder_ / "open.glb", std::span(&open, 1));
  expect_refused_soon({"bench", "--scene", folder_ / "open.glb"}, folder_ / "open.glb");
}

TEST_F(BadFiles, ARigsLayoutIsNamedWithItsLine) {
  const std::string rig = folder_ / "rig.toml", line = rig + ": line 10: layout is ";
  for (const auto& [layout, told] :
       {std::pair<std::string, std::string>{"nope", line + "nope, neither a file nor a known layout; known: autd3"},
        {"nope.toml", line + (folder_ / "nope.toml").string() + ", neither a file nor a known layout"}}) {
    write_text(rig, std::string(tiny_camera) + "[array]\nlayout = \"" + layout + "\"\n");
    expect_refused({"run", "--scene", cube_, "--rig", rig}, {{{}, told, 4}});
  }
}

TEST_F(BadFiles, ACameraThatDoesNotFitItsImageIsToldTheSizes) {
  const std::string image = folder_ / "depth.png";
  sensing::write_png16(image, 8, 5, std::vector<std::uint16_t>(40, 300));
  for (const std::string& told : {image, std::string("8x5"), std::string("8x4")})
    expect_refused({"touch", "--scene", cube_, "--depth", image, "--camera", camera_}, {{{}, told, 4}});
}

class CliReferences : public testing::Test {
 protected:
  CliReferences() {
    fs::create_directory(folder_);
    write_text(top_ / "short.bin", "Q7");  // of another, who has secrets
    write_tetrahedron(top_ / "whole.bin");
    write_text(folder_ / "beside.bin", "Q7");
    fs::create_symlink("../short.bin", folder_ / "link.bin");
    fs::create_symlink("..", folder_ / "up");
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  /// The line is refused where references stay inside, and goes further with --allow-outside, to the error `further`.
  static void expect_inside(const std::vector<std::string>& line, const std::string& further) {
    expect_refused(line, {{{}, "--allow-outside", 4}, {{"--allow-outside"}, further, 4}});
  }
  static void expect_success(const std::vector<std::string>& line) { succeeded(palpa_here(line)); }
  std::vector<std::string> touch_model() const {
    return {"touch", "--scene", path("model.gltf"), "--points", points_, "--backend", "cpu"};
  }

  fs::path top_ = scratch_folder("references"), folder_ = top_ / "theirs";
  std::string points_ = source_file("assets/finger.ply"), cube_ = source_file("assets/cube.glb");
};

TEST_F(CliReferences, OfScenesStayInTheirFolderWhateverReadsThem) {
  write_scene(folder_ / "model.gltf", "../short.bin");
  const std::string model = path("model.gltf");
  for (const std::vector<std::string>& line : std::vector<std::vector<std::string>>{
           {"touch", "--scene", model, "--points", points_},
           {"run", "--scene", model},
           {"run", "--scene", cube_, "--source", "synthetic:" + model},
           {"export", "--scene", model, "--frames", "1", "--foci", "-"},
           {"decompose", "--scene", model, "--out", "-"},
           {"simulate", "--scene", model, "--finger", points_},
           {"simulate", "--scene", cube_, "--finger", model},
           {"scatter", "--mesh", model, "--plane-wave", "0,0,1"},
           {"drive", "--layout", "openmpd", "--focus", "0,0,0.1", "--transfer", "finger", "--mesh", model},
           {"calibrate", "--source", "synthetic:" + model},
           {"calibrate", "--nudge", "--scene", model, "--keys", "enter", "--out", path("out.toml")}})
    expect_inside(line, "has 2 bytes");
}

// base/test_reference.cpp has every way out of a folder.
TEST_F(CliReferences, OfScenesAreDecodedFirst) {
  for (const char* uri : {"%2e%2e/short.bin", "..%2Fshort.bin", "link.bin", "up/theirs/link.bin"}) {
    write_scene(folder_ / "model.gltf", uri);
    expect_inside(touch_model(), "has 2 bytes");
  }
  for (const char* uri : {"up/theirs/beside.bin", "%2e/beside.bin"}) {
    write_scene(folder_ / "model.gltf", uri);
    expect_refused(touch_model(), {{{}, "has 2 bytes", 4}});
  }
  // Pictures are not opened, wherever they are: a pipe would be waited for, a folder refused.
  ASSERT_EQ(mkfifo((top_ / "pipe").c_str(), 0600), 0);
  write_scene(folder_ / "model.gltf", "whole.bin", "../pipe");
  fs::copy_file(top_ / "whole.bin", folder_ / "whole.bin");
  expect_success(touch_model());
  write_scene(folder_ / "model.gltf", "../whole.bin");
  expect_success(with(touch_model(), {"--allow-outside"}));
}

TEST_F(CliReferences, OfRecordingsStayInTheirFolder) {
  write_depth(top_ / "depth-0.png");
  write_depth(folder_ / "depth-0.png");
  fs::create_symlink("../depth-0.png", folder_ / "link-0.png");
  write_text(top_ / "times.csv", "Q7 secret\n");
  write_text(top_ / "mask.png", "Q7 secret\n");
  const auto run_from = [&](const std::string& recording) {
    return std::vector<std::string>{"run",      "--scene", cube_,      "--source", "recording:" + recording,
                                    "--frames", "1",       "--layout", "openmpd",  "--backend",
                                    "cpu"};
  };
  const std::vector<std::string> run = run_from(folder_);
  const auto with_keys = [&](const std::string& keys, const std::string& mask = {}) {
    write_recording(folder_ / "recording.toml", keys, mask);
    return run;
  };
  expect_success(with_keys("files = [\"depth-%d.png\"]\n"));
  for (const std::string& name :
       {std::string("up/depth-%d.png"), std::string("link-%d.png"), (top_ / "depth-%d.png").string()}) {
    for (const std::string count : {"", "count = 1\n"})
      expect_refused(with_keys(count + "files = [\"" + name + "\"]\n"), {{{}, "--allow-outside", 4}});
    expect_success(with(run, {"--allow-outside"}));
  }
  expect_refused(with_keys("[[frame]]\ntime_s = 1\nfiles = [\"../depth-0.png\"]\n"), {{{}, "--allow-outside", 4}});
  expect_inside(with_keys("files = [\"depth-%d.png\"]\ntimes = \"../times.csv\"\n"), "expected the heading");
  expect_inside(with_keys("files = [\"depth-%d.png\"]\n", "../mask.png"), "is not a PNG file");
  // The recording may be a link itself, out of the folder that the user names; its own name is the user's.
  with_keys("files = [\"depth-%d.png\"]\n");
  fs::rename(folder_ / "recording.toml", top_ / "recording.toml");
  fs::create_symlink("../recording.toml", folder_ / "recording.toml");
  expect_refused(run, {{{}, "--allow-outside", 4}});
  expect_success(run_from(path("recording.toml")));
}

TEST_F(CliReferences, ArePlacedByRigsAndLayoutsAsTheUserLikes) {
  write_text(top_ / "mine.toml", "[[transducer]]\nposition_m = [0, 0, 0]\naxis = [0, 0, 1]\n");
  sensing::write_png8(top_ / "mask.png", 8, 4, std::vector<std::uint8_t>(32, 1));
  write_text(folder_ / "rig.toml",
             std::string(tiny_camera) + "mask = \"../mask.png\"\n[array]\nlayout = \"../mine.toml\"\n");
  expect_success({"run", "--scene", cube_, "--rig", path("rig.toml"), "--frames", "1", "--backend", "cpu"});
}

// Whatever file is given for whatever is wanted: nothing of it is shown.
TEST_F(CliReferences, NoMessageShowsWhatIsNoFileOfItsKind) {
  for (const char* contents : {"Q7Zecret:Q7Zecret:1\n",
                               "Q7Zecret\n",
                               "Q7Zecret = \n",
                               "a = Q7Zecret\n",
                               "a = \"Q7Zecret\nb = 1",
                               "[Q7Zecret\n",
                               "a = 1Q7Zecret\n",
                               "a = '''Q7Zecret",
                               "a = [1, 2 Q7Zecret",
                               "\"\\Q7Zecret\" = 1\n",
                               "a.Q7Zecret = 1\na.Q7Zecret = 1\n",
                               "{Q7Zecret}\n",
                               "{\"a\": Q7Zecret}\n",
                               "sn Q7Zecret 256\n",
                               "1 Q7Zecret\n",
                               "1 2 3 Q7Zecret\n",
                               "Q7Zecret = 1\n",
                               "[Q7Zecret]\n",
                               "[[Q7Zecret]]\na = 1\n",
                               "[\"Q7Zecret\"]"}) {
    SCOPED_TRACE(contents);
    const std::string file = path("theirs");
    write_text(file, contents);
    write_text(folder_ / "theirs.toml", std::string(tiny_camera) + "[array]\nlayout = \"theirs\"\n");
    fs::create_directories(folder_ / "board");
    write_text(folder_ / "board/board_A.pat", contents);
    write_text(folder_ / "board" / serial_board_file(), contents);
    write_text(folder_ / "model.glb", contents);
    for (const std::vector<std::string>& line : std::vector<std::vector<std::string>>{
             {"touch", "--scene", path("model.glb"), "--points", points_},
             {"touch", "--scene", cube_, "--points", file},
             {"touch", "--scene", cube_, "--depth", file},
             {"touch", "--scene", cube_, "--depth", file, "--camera", file},
             {"run", "--scene", cube_, "--rig", file},
             {"run", "--scene", cube_, "--rig", path("theirs.toml")},
             {"run", "--scene", cube_, "--source", "recording:" + file},
             {"run", "--scene", cube_, "--source", "bag:" + file},
             {"drive", "--layout", file, "--focus", "0,0,0.1"},
             {"drive", "--layout", "openmpd", "--touch", file},
             {"field", "--layout", "openmpd", "--drive", file, "--plane", "xy", "--size", "1cm,1cm"},
             {"field", "--layout", "openmpd", "--focus", "0,0,0.1", "--points", file},
             {"emulate", "openmpd", "--board-files", path("board")},
             {"link", "test", "--layout", serial_board(), "--link", serial_board() + ":/dev/null", "--board-files",
              path("board")}}) {
      const std::vector<std::string> all = with(line, {"--backend", "cpu"});
      // The program starts palpa-guard, which holds the board, from its own folder.
      const Result result = line[0] == "link" ? palpa(all) : palpa_here(all);
      EXPECT_NE(result.exit_code, 0) << line[0] << ' ' << line[2];
      EXPECT_EQ((result.err + result.out).find("Q7Z"), std::string::npos)
          << line[0] << ' ' << line[2] << ": " << result.err;
    }
  }
}

}  // namespace
}  // namespace palpa::test
