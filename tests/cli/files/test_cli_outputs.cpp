// Outputs are rejected before long work. All messages about them are short and printable. test_cli_aliases.cpp shows
// that none takes the place of an input or of another.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <filesystem>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/text.hpp"
#include "cli/support/boxes.hpp"
#include "cli/support/heard_drives.hpp"
#include "cli/support/here.hpp"
#include "cli/support/process.hpp"
#include "cli/support/told.hpp"
#include "geometry/gltf/gltf.hpp"
#include "geometry/gltf/write.hpp"
#include "support/files.hpp"
#include "support/instrumented.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa::test {
namespace {

namespace fs = std::filesystem;

class CliOutputs : public testing::Test {
 protected:
  fs::path folder_ = scratch_folder("outputs");
  std::string scene_ = copy("cube.glb"), points_ = copy("finger.ply");

  /// An asset in the test's folder.
  std::string copy(const std::string& name) const {
    fs::create_directories((folder_ / name).parent_path());
    fs::copy_file(source_file("assets/" + name), folder_ / name);
    return (folder_ / name).string();
  }
  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  std::vector<std::string> touch(const std::vector<std::string>& more) const {
    return with({"touch", "--scene", scene_, "--points", points_, "--backend", "cpu", "--penetration", "3mm"}, more);
  }
  std::vector<std::string> run(const std::vector<std::string>& more) const {
    return with({"run", "--scene", scene_, "--frames", "3", "--every-frame", "--backend", "cpu"}, more);
  }
  /// The lines are refused, and every file is unchanged.
  void expect_untouched(const std::vector<std::string>& line, const std::vector<Told>& all) const {
    const auto before = contents_of(folder_);
    expect_refused(line, all);
    EXPECT_TRUE(contents_of(folder_) == before);
  }
};

TEST_F(CliOutputs, ThatCannotBeWrittenAreRefusedAtTheStart) {
  // The scene is never looked at: it is missing, which would be exit code 4.
  for (const std::string& place : {path("no/such/folder/x.json"), folder_.string()}) {
    const std::string told = place + ": cannot be written: ";
    expect_untouched(
        {"run", "--scene", path("absent.glb")},
        {{{"--json", place}, told, 1}, {{"--events", place}, told, 1}, {{"--link", "record:" + place}, told, 1}});
    expect_untouched({"decompose", "--scene", path("absent.glb"), "--out", place}, {{{}, told, 1}});
  }
  fs::create_directory(path("used"));
  fs::create_directory(path("empty"));
  write_text(path("used/notes.txt"), "mine");
  expect_untouched(run({"--record"}), {{{path("used/notes.txt")}, "name a new folder", 1},
                                       {{path("no/such")}, path("no/such") + ": cannot be written: ", 1},
                                       {{path("empty"), "--json", path("empty/times.csv")}, "lies in the folder"}});
  succeeded(palpa_here(run(with(small_frames(), {"--record", path("empty/")}))));
  EXPECT_TRUE(fs::exists(path("empty/recording.toml")));
  EXPECT_EQ(palpa_here(touch({"--json", "/dev/null", "--csv", "/dev/null"})).exit_code, 0) << "a device is nobody's";
}

TEST_F(CliOutputs, OnStdoutAreAlone) {
  const Result parts = succeeded(palpa_here({"decompose", "--scene", scene_, "--parts", "4", "--out", "-"}));
  write_text(path("parts.glb"), parts.out);
  EXPECT_FALSE(geometry::load_gltf(path("parts.glb")).meshes.empty());
  EXPECT_FALSE(fs::exists("-"));
  const Result drives = succeeded(palpa(run(with(small_frames(), {"--link", "record:-"}))));
  write_text(path("drives.bin"), drives.out);
  read_to_silence(path("drives.bin"));
  const std::string told = "would mix on stdout";
  expect_untouched({"decompose", "--scene", scene_, "--out", "-", "--json", "-"}, {{{}, told}});
  expect_untouched(run({"--link", "record:-"}),
                   {{{"--stats", "json"}, told}, {{"--json", "-"}, told}, {{"--events", "-"}, told}});
}

TEST_F(CliOutputs, AnyNameOfStdoutIsStdout) {
  const std::vector<std::string> drive{"drive", "--layout", "openmpd", "--focus", "0,0,150mm", "--backend", "cpu"};
  const std::string alone = palpa_here(with(drive, {"--csv", "-"})).out;
  EXPECT_EQ(palpa(with(drive, {"--csv", "/dev/stdout"})).out, alone) << "a pipe";
  for (const std::string& name : {std::string("/dev/stdout"), path("out.csv")}) {
    SCOPED_TRACE(name);
    write_text(path("out.csv"), "");
    succeeded(palpa_here(with(drive, {"--csv", name}), path("out.csv")));
    EXPECT_EQ(read_text(path("out.csv")), alone) << "no summary over it";
    expect_failure(palpa_here(with(drive, {"--csv", name, "--json", "-"}), path("out.csv")), 2, "would mix on stdout");
  }
}

TEST_F(CliOutputs, LongPreparationTellsALogEachStep) {
  const std::vector<std::string> with_ball{"touch",     "--scene", path("ball.glb"), "--points", points_,
                                           "--backend", "cpu",     "--json",         "-"};
  const std::string step = "preparing mesh \"ball\"";
  Result told;
  // It must take a few tenths of a second, also on a fast machine.
  for (int rings = instrumented() ? 80 : 110; rings <= 440 && told.err.find(step) == std::string::npos; rings *= 2) {
    const geometry::SceneMesh ball{"ball", bumpy_ball(rings)};
    geometry::write_glb(path("ball.glb"), std::span(&ball, 1));
    told = succeeded(palpa_here(with(with_ball, {"--log-level", "info"})));
  }
  EXPECT_CONTAINS(told.err, "palpa: info: ");
  EXPECT_CONTAINS(told.err, step);
  EXPECT_EQ(palpa_here(with_ball).err, "");
}

TEST_F(CliOutputs, MessagesAreShortAndPrintable) {
  const std::string wild = "\x1b[31m\xff\xe2\x80\xae\n";
  std::string long_name;
  while (long_name.size() < 5000)
    long_name += wild;
  geometry::Scene scene = geometry::load_gltf(scene_);
  scene.meshes[0].mesh.triangles.pop_back();  // no solid
  scene.meshes[0].name = long_name;
  geometry::write_glb(path("wild.glb"), scene.meshes);
  write_text(path("wild.toml"), "[[camera]]\n" + std::string(3000, 'k') + " = 1\n");
  for (const std::vector<std::string>& line :
       {std::vector<std::string>{"touch", "--scene", path("wild.glb"), "--points", points_},
        {"touch", "--scene", path(std::string(200, 'x') + wild) + std::string(3000, '\x1b'), "--points", points_},
        {"touch", "--scene", scene_, "--points", points_, "--camera", std::string(100'000, '\xfe')},
        {"run", "--scene", scene_, "--rig", path("wild.toml")},
        {"run", "--scene", scene_, "--link", std::string(100'000, '\n')},
        {"drive", "--layout", "autd3", "--focus", std::string(100'000, '\x9b')},
        {"drive", "--" + std::string(100'000, 'a') + wild}}) {
    const Result result = palpa_here(line);
    EXPECT_NE(result.exit_code, 0);
    ASSERT_EQ(result.err_lines().size(), 1u) << result.err;
    const std::string told = result.err_lines()[0];
    EXPECT_LE(told.size(), 500u);
    EXPECT_EQ(printable(told), told);
  }
  // The name's beginning, and what would be right.
  for (const char* part : {"mesh \"\\x1b[31m", "closed and consistently oriented"})
    expect_refused({"touch", "--scene", path("wild.glb"), "--points", points_}, {{{}, part, 4}});
}

}  // namespace
}  // namespace palpa::test
