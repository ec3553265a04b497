// Outputs never destroy an input or each other, are rejected before long work, and end as promised on a full disk. All
// messages about them are short and printable.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <set>
#include <utility>

#include "base/text.hpp"
#include "cli/support/here.hpp"
#include "cli/support/process.hpp"
#include "cli/support/terminal.hpp"
#include "geometry/gltf/gltf.hpp"
#include "geometry/gltf/write.hpp"
#include "sensing/grey_png.hpp"
#include "session/links/record_link.hpp"
#include "support/file_size_limit.hpp"
#include "support/files.hpp"
#include "support/instrumented.hpp"
#include "support/json.hpp"
#include "support/pseudo_terminal.hpp"
#include "support/shapes.hpp"
#include "support/shared_data.hpp"
#include "support/side_by_side.hpp"
#include "support/time_limits.hpp"

namespace palpa::test {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

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

  /// Every file and folder with its bytes.
  std::vector<std::pair<std::string, std::string>> contents() const {
    std::vector<std::pair<std::string, std::string>> all;
    for (const auto& entry : fs::recursive_directory_iterator(folder_))
      all.emplace_back(entry.path().string(), entry.is_regular_file() ? read_text(entry.path()) : "");
    std::sort(all.begin(), all.end());
    return all;
  }
  std::vector<std::string> touch(const std::vector<std::string>& more) const {
    std::vector<std::string> line{"touch",     "--scene", scene_,          "--points", points_,
                                  "--backend", "cpu",     "--penetration", "3mm"};
    line.insert(line.end(), more.begin(), more.end());
    return line;
  }
  std::vector<std::string> run(const std::vector<std::string>& more) const {
    std::vector<std::string> line{"run", "--scene", scene_, "--frames", "3", "--every-frame", "--backend", "cpu"};
    line.insert(line.end(), more.begin(), more.end());
    return line;
  }
  /// The line is refused, and every file is unchanged.
  void expect_untouched(const std::vector<std::string>& line, int code, const std::string& part) {
    SCOPED_TRACE(line[0] + " " + line[line.size() - 2] + " " + line.back());
    const auto before = contents();
    expect_failure(palpa_here(line), code, part);
    EXPECT_TRUE(contents() == before);
    // Also run a test's first line of each command with the program itself.
    if (!programs_.insert(line[0]).second) return;
    expect_failure(palpa(line), code, part);
    EXPECT_TRUE(contents() == before);
  }

  std::set<std::string> programs_;
};

TEST_F(CliOutputs, NeverTakeThePlaceOfAnInput) {
  fs::create_symlink(scene_, path("soft.glb"));
  fs::create_hard_link(scene_, path("hard.glb"));
  const std::string remedy = "is read by this command, name another file";
  for (const std::string option : {"--json", "--csv"}) {
    for (const std::string& file : {scene_, points_, path("soft.glb"), path("hard.glb")})
      expect_untouched(touch({option, file}), 2, option + ": ");
    expect_untouched(touch({option, scene_}), 2, remedy);
  }
  expect_untouched({"decompose", "--scene", scene_, "--out", path("soft.glb")}, 2, remedy);
  for (const std::string& file : {scene_, path("soft.glb"), path("hard.glb")}) {
    expect_untouched(run({"--json", file}), 2, remedy);
    expect_untouched(run({"--events", file}), 2, remedy);
    expect_untouched(run({"--link", "record:" + file}), 2, remedy);
    expect_untouched(run({"--events", path("new"), "--link", "record:" + file}), 2, remedy);
  }
  expect_untouched(run({"--source", "synthetic:" + points_, "--events", points_}), 2, remedy);
}

TEST_F(CliOutputs, NorOfWhatAnInputRefersTo) {
  std::ofstream(path("picture.png")) << "a texture that palpa does not look at";
  // A triangle mesh in a file of its own, by way of a tetrahedron.
  const float corners[] = {0, 0, 0, .1f, 0, 0, 0, .1f, 0, 0, 0, .1f};
  const std::uint16_t faces[] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
  std::ofstream bin(path("part s.bin"), std::ios::binary);
  bin.write(reinterpret_cast<const char*>(corners), sizeof(corners));
  bin.write(reinterpret_cast<const char*>(faces), sizeof(faces));
  bin.close();
  std::ofstream(path("model.gltf")) << R"({"asset":{"version":"2.0"},"images":[{"uri":"picture.png"}],
    "buffers":[{"uri":"part%20s.bin","byteLength":72}],
    "bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":24}],
    "accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[0.1,0.1,0.1]},
                 {"bufferView":1,"componentType":5123,"count":12,"type":"SCALAR"}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],"nodes":[{"mesh":0}]})";
  const std::vector<std::string> line{"touch", "--scene", path("model.gltf"), "--points", points_, "--backend", "cpu"};
  const auto with = [](std::vector<std::string> all, const std::vector<std::string>& more) {
    all.insert(all.end(), more.begin(), more.end());
    return all;
  };
  EXPECT_EQ(palpa_here(line).exit_code, 0);
  expect_untouched(with(line, {"--csv", path("part s.bin")}), 2, "is read by this command");
  expect_untouched(with(line, {"--json", path("picture.png")}), 2, "is read by this command");

  const std::string rig = copy("rigs/paper.toml");
  std::ofstream(path("mine.toml")) << "[[transducer]]\nposition_m = [0, 0, 0]\naxis = [0, 0, 1]\n";
  std::string text = read_text(rig);
  const std::size_t at = text.find("layout = \"paper\"");
  ASSERT_NE(at, std::string::npos);
  std::ofstream(rig) << text.replace(at, 16, "layout = \"../mine.toml\"");
  for (const std::string& file : {rig, path("mine.toml")})
    expect_untouched(run({"--rig", rig, "--layout", "autd3", "--json", file}), 2, "is read by this command");

  // A camera's mask, of the rig and of what was recorded by it.
  sensing::write_png8(path("sleeves.png"), 848, 480, std::vector<std::uint8_t>(std::size_t{848} * 480, 1));
  text = read_text(rig);
  std::ofstream(rig) << text.replace(text.find("[[camera]]"), 10, "[[camera]]\nmask = \"../sleeves.png\"");
  expect_untouched(run({"--rig", rig, "--layout", "autd3", "--json", path("sleeves.png")}), 2,
                   "is read by this command");

  ASSERT_EQ(palpa_here(run({"--rig", rig, "--layout", "autd3", "--record", path("take")})).exit_code, 0);
  for (const char* file : {"take/recording.toml", "take/times.csv", "take/000001-1.png", "take/mask-0.png"})
    expect_untouched(run({"--source", "recording:" + path("take"), "--link", "record:" + path(file)}), 2,
                     "is read by this command");
}

TEST_F(CliOutputs, NeverTakeThePlaceOfOneAnother) {
  std::ofstream(path("out")) << "what was";
  fs::create_symlink(path("out"), path("link"));
  fs::create_symlink(path("new"), path("link-to-new"));
  expect_untouched(touch({"--json", path("out"), "--csv", path("link")}), 2, "--json and --csv name the same file");
  expect_untouched(touch({"--json", path("new"), "--csv", path("new")}), 2, "give each its own");
  expect_untouched(touch({"--json", path("new"), "--csv", path("link-to-new")}), 2, "give each its own");
  expect_untouched(run({"--events", path("out"), "--link", "record:" + path("out")}), 2, "name the same file");
  fs::create_directory(path("empty"));
  expect_untouched(run({"--record", path("empty"), "--json", path("empty/times.csv")}), 2, "lies in the folder");
  const Result both = palpa_here(touch({"--json", "/dev/null", "--csv", "/dev/null"}));
  EXPECT_EQ(both.exit_code, 0) << both.err;
}

TEST_F(CliOutputs, ThatCannotBeWrittenAreRefusedAtTheStart) {
  // The scene is never looked at: it is missing, which would be exit code 4.
  for (const std::string& place : {path("no/such/folder/x.json"), folder_.string()}) {
    for (const char* option : {"--json", "--events", "--link"}) {
      const std::string target = option == std::string("--link") ? "record:" + place : place;
      expect_untouched({"run", "--scene", path("absent.glb"), option, target}, 1, place + ": cannot be written: ");
    }
    expect_untouched({"decompose", "--scene", path("absent.glb"), "--out", place}, 1, place + ": cannot be written: ");
  }
  fs::create_directory(path("used"));
  std::ofstream(path("used/notes.txt")) << "mine";
  expect_untouched(run({"--record", path("used")}), 2, "is not empty; name a new folder");
  expect_untouched(run({"--record", path("used/")}), 2, "is not empty; name a new folder");
  expect_untouched(run({"--record", path("used/notes.txt")}), 1, "name a new folder");
  expect_untouched(run({"--record", path("no/such")}), 1, path("no/such") + ": cannot be written: ");
  fs::create_directory(path("empty"));
  EXPECT_EQ(palpa(run(with(small_frames(), {"--record", path("empty/")}))).exit_code, 0);
  EXPECT_TRUE(fs::exists(path("empty/recording.toml")));
}

TEST_F(CliOutputs, DecomposeWritesToStdout) {
  const Result result = palpa({"decompose", "--scene", scene_, "--parts", "4", "--out", "-"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  std::ofstream(path("parts.glb"), std::ios::binary) << result.out;
  EXPECT_FALSE(geometry::load_gltf(path("parts.glb")).meshes.empty());
  EXPECT_FALSE(fs::exists("-"));
  expect_failure(palpa_here({"decompose", "--scene", scene_, "--out", "-", "--json", "-"}), 2, "would mix on stdout");
}

TEST_F(CliOutputs, DrivesOnStdoutAreAlone) {
  const Result result = palpa(run(with(small_frames(), {"--link", "record:-"})));
  ASSERT_EQ(result.exit_code, 0) << result.err;
  std::ofstream(path("drives.bin"), std::ios::binary) << result.out;
  const session::DriveRecording recording = session::read_drive_recording(path("drives.bin"));
  ASSERT_FALSE(recording.drives.empty());
  for (const array::TransducerDrive& last : recording.drives.back().drive)
    ASSERT_EQ(last.amplitude, 0);
  for (const std::vector<std::string>& other :
       {std::vector<std::string>{"--stats", "json"}, {"--json", "-"}, {"--events", "-"}}) {
    std::vector<std::string> line = run({"--link", "record:-"});
    line.insert(line.end(), other.begin(), other.end());
    expect_untouched(line, 2, "would mix on stdout");
  }
}

TEST_F(CliOutputs, AnyNameOfStdoutIsStdout) {
  const std::vector<std::string> drive{"drive", "--layout", "openmpd", "--focus", "0,0,150mm", "--backend", "cpu"};
  ASSERT_EQ(palpa_here(with(drive, {"--csv", path("alone.csv")})).exit_code, 0);
  const std::string alone = read_text(path("alone.csv"));
  for (const std::string& name : {std::string("/dev/stdout"), path("out.csv")}) {
    SCOPED_TRACE(name);
    std::ofstream(path("out.csv")).flush();
    const Result result = palpa(with(drive, {"--csv", name}), {.environment = {}, .stdout_file = path("out.csv")});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(read_text(path("out.csv")), alone) << "no summary over it";
    expect_failure(
        palpa(with(drive, {"--csv", name, "--json", "-"}), {.environment = {}, .stdout_file = path("out.csv")}), 2,
        "would mix on stdout");
  }
  const Result piped = palpa(with(drive, {"--csv", "/dev/stdout"}));
  EXPECT_EQ(piped.out, alone);
  // A device is nobody's.
  EXPECT_EQ(
      palpa(with(drive, {"--csv", "/dev/null", "--json", "/dev/null"}), {.environment = {}, .stdout_file = "/dev/null"})
          .exit_code,
      0);
}

TEST_F(CliOutputs, DrivesEndSilentlyWhereTheDiskIsFull) {
  constexpr std::size_t header = 24, record = 8 + 3984 * 8;
  for (const std::size_t limit : {header + record / 2, header + record, header + 20 * record + 77}) {
    Result result;
    {
      const FileSizeLimit full(limit);
      result = palpa(with({"run", "--scene", scene_, "--frames", "60", "--hold", "1s", "--backend", "cpu", "--link",
                           "record:" + path("drives.bin")},
                          small_frames()));
    }
    expect_failure(result, 1, path("drives.bin") + ": cannot be written: File too large");
    const session::DriveRecording recording = session::read_drive_recording(path("drives.bin"));
    ASSERT_EQ(recording.drives.size(), (limit - header) / record);
    if (recording.drives.empty()) continue;
    for (const array::TransducerDrive& last : recording.drives.back().drive)
      ASSERT_EQ(last.amplitude, 0);
  }
}

/// Prepared within seconds, not within a moment.
geometry::SceneMesh bumpy_ball(int rings) {
  geometry::Mesh ball = sphere(0.05, rings, rings);
  for (Vec3& p : ball.positions)
    p *= 1 + 0.1 * std::sin(120 * p.x) * std::sin(130 * p.y);
  return {"ball", std::move(ball)};
}

TEST_F(CliOutputs, LongPreparationSaysWhatItDoesAndStopsOnCtrlC) {
  PALPA_TERMINAL_OR_SKIP();
  const geometry::SceneMesh ball = bumpy_ball(450);
  geometry::write_glb(path("ball.glb"), std::span(&ball, 1));
  const auto before = contents();
  setenv("PALPA_CACHE", "off", 1);
  Terminal touch(
      {"touch", "--scene", path("ball.glb"), "--points", points_, "--backend", "cpu", "--json", path("out.json")}),
      run({"run", "--scene", path("ball.glb"), "--backend", "cpu", "--link", "record:" + path("drives.bin")});
  for (const char* part : {"checking mesh \"ball\" of 404100 triangles", "preparing mesh \"ball\": ", " %"}) {
    for (Terminal* terminal : {&touch, &run})
      EXPECT_TRUE(terminal->shows(part)) << terminal->text();
  }
  for (Terminal* terminal : {&touch, &run}) {
    terminal->type("\x03");
    EXPECT_EQ(terminal->ended_by_signal(), SIGINT) << terminal->text();
    EXPECT_LT(terminal->processor_s_to_end(), slowest);
    EXPECT_TRUE(contents() == before) << "nothing was written";
  }
  unsetenv("PALPA_CACHE");
}

TEST_F(CliOutputs, LongPreparationTellsALogEachStep) {
  const geometry::SceneMesh ball = bumpy_ball(instrumented() ? 80 : 110);  // takes a few tenths of a second
  geometry::write_glb(path("ball.glb"), std::span(&ball, 1));
  RunOptions fresh;
  fresh.environment = {{"PALPA_CACHE", "off"}};
  const std::vector<std::string> with_ball{"touch", "--scene",     path("ball.glb"), "--points", points_, "--backend",
                                           "cpu",   "--log-level", "info",           "--json",   "-"};
  std::vector<std::string> silent = with_ball;
  silent[8] = "warning";
  side_by_side({[&] {
                  const Result told = palpa(with_ball, fresh);
                  EXPECT_EQ(told.exit_code, 0) << told.err;
                  EXPECT_NE(told.err.find("palpa: info: "), std::string::npos) << told.err;
                  EXPECT_NE(told.err.find("preparing mesh \"ball\""), std::string::npos) << told.err;
                },
                [&] { EXPECT_EQ(palpa(silent, fresh).err, ""); }});
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
  std::ofstream(path("wild.toml")) << "[[camera]]\n" + std::string(3000, 'k') + " = 1\n";
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
  const std::string told = palpa({"touch", "--scene", path("wild.glb"), "--points", points_}).err;
  EXPECT_NE(told.find("mesh \"\\x1b[31m"), std::string::npos) << "the name's beginning is printed: " << told;
  EXPECT_NE(told.find("closed and consistently oriented"), std::string::npos) << "and what would be right: " << told;
}

}  // namespace
}  // namespace palpa::test
