// No command overwrites its input, or one output with another, under any name: the same path, symbolic and hard links,
// "..", "//", /proc/self/fd. All of this is rejected before any long work begins.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "cli/support/every_command.hpp"
#include "cli/support/here.hpp"
#include "cli/support/process.hpp"
#include "cli/support/tiny_files.hpp"
#include "support/files.hpp"
#include "support/instrumented.hpp"
#include "support/shared_data.hpp"
#include "support/study_files.hpp"

namespace palpa::test {
namespace {

namespace fs = std::filesystem;

/// An option that names a file that is written: "--link record:" and the name, which ends so.
struct OutputOption {
  std::string option, prefix, ending;
};

struct Line {
  std::vector<std::string> words;
  std::vector<std::string> inputs;  ///< files that these words name, or what those refer to
  std::vector<OutputOption> outputs;
};

class CliAliases : public testing::Test {
 protected:
  CliAliases() {
    fs::create_directories(folder_ / "deep");
    fs::create_directories(folder_ / "take");
    fs::create_directories(folder_ / "boards");
    write_tetrahedron(folder_ / "corners.bin");
    write_scene(folder_ / "scene.gltf", "corners.bin");
    write_text(folder_ / "picture.png", "that nobody looks at");
    fs::copy_file(source_file("assets/finger.ply"), folder_ / "finger.ply");
    write_text(folder_ / "layout.toml", "[[transducer]]\nposition_m = [0, 0, -0.1]\naxis = [0, 0, 1]\n");
    sensing::write_png8(folder_ / "mask.png", 8, 4, std::vector<std::uint8_t>(32, 1));
    write_text(folder_ / "rig.toml",
               std::string(tiny_camera) + "mask = \"mask.png\"\n[array]\nlayout = \"layout.toml\"\n");
    write_text(folder_ / "camera.toml", tiny_camera);
    write_depth(folder_ / "depth.png");
    write_depth(folder_ / "take/depth-0.png");
    sensing::write_png8(folder_ / "take/mask.png", 8, 4, std::vector<std::uint8_t>(32, 1));
    write_text(folder_ / "take/times.csv", "sequence,time_0_s\n0,0.5\n");
    write_recording(folder_ / "take/recording.toml", "files = [\"depth-%d.png\"]\ntimes = \"times.csv\"\n", "mask.png");
    write_text(folder_ / "drive.csv", "index,x,y,z,nx,ny,nz,amplitude,phase\n0,0,0,-0.1,0,0,1,1,0\n");
    write_text(folder_ / "pattern.toml", "[[point]]\nposition_m = [0, 0, 0.1]\n");
    write_text(folder_ / "touch.json",
               R"({"fingers":[{"foci_m":[[0,0,0.1]]}],"schedule":{"order":[0],"dwell_s":0.0015}})");
    write_text(folder_ / "played.json",
               R"({"slot_s":0.0015,"frames":[{"slot":0,"time_s":0,"fingers":[{"id":0,"solid":"","foci_m":[[0,0,0.1]],)"
               R"("order":[0],"dwell_s":0.0015,"modulation_hz":0,"gain":1}]}]})");
    write_text(folder_ / "boards/board_A.pat", "A 256 128\n");
    write_text(folder_ / "boards/sonicsurface.txt", "0\n");
    write_participant(folder_ / "study", 1, {{"m", 20}});
    write_text(folder_ / finger_, "not looked at before it is refused");
    write_text(folder_ / "study/sub-1/beh/sub-1_task-shapes_run-1_recording-finger_physio.json",
               R"({"SamplingFrequency": 50, "StartTime": 0, "Columns": ["depth"]})");
    write_text(folder_ / "counts.csv", "actual,cube,prism\ncube,3,1\nprism,1,3\n");
    write_text(folder_ / "take.bag", "#ROSBAG V2.0\n");
    write_text(folder_ / "study.toml",
               "[[shape]]\nname = \"a\"\nmodel = \"scene.gltf\"\n[[shape]]\nname = \"b\"\nmodel = \"scene.gltf\"\n"
               "[[method]]\nname = \"single-focus\"\nlayout = \"layout.toml\"\n"
               "[fit]\nmethod = \"single-focus\"\naccuracy = 0.6\ntrials = 30\n");
    write_text(folder_ / "old", "what was");
    for (const auto& entry : fs::recursive_directory_iterator(folder_)) {
      if (entry.is_regular_file()) contents_[entry.path()] = read_text(entry.path());
    }
  }

  std::string path(const std::string& name) const { return (folder_ / name).string(); }

  /// Other names of a file, those that can end so with that ending. Descriptors stay open until the test ends.
  std::vector<std::string> names_of(const std::string& file, const std::string& ending) {
    const fs::path at(path(file));
    const std::string soft = path("soft" + ending), hard = path("hard" + ending);
    fs::remove(soft);
    fs::remove(hard);
    fs::create_symlink(at, soft);
    std::vector<std::string> names{soft};
    if (fs::exists(at)) {
      fs::create_hard_link(at, hard);
      names.push_back(hard);
    }
    if (!ending.empty() && !file.ends_with(ending)) return names;
    names.push_back(at.string());
    names.push_back(at.parent_path().string() + "/../" + at.parent_path().filename().string() + "/" +
                    at.filename().string());
    names.push_back(at.parent_path().string() + "//" + at.filename().string());
    if (!fs::exists(at) || !ending.empty()) return names;
    const int open = ::open(at.c_str(), O_RDWR);  // the program inherits it
    descriptors_.push_back(open);
    names.push_back("/proc/self/fd/" + std::to_string(open));
    return names;
  }

  void expect_refused(const std::vector<std::string>& words, const std::string& part) {
    std::string line;
    for (const std::string& word : words)
      line += word + ' ';
    SCOPED_TRACE(line);
    expect_failure(palpa_here(words), 2, part);
    // Also run one line of each command with the program itself.
    if (programs_.insert(words[0]).second) {
      RunOptions options;
      options.timeout_s = 20;
      expect_failure(palpa(words, options), 2, part);
    }
    for (const auto& [file, text] : contents_)
      ASSERT_EQ(read_text(file), text) << file;
    ASSERT_FALSE(fs::exists(path("new"))) << "no output was created";
    ASSERT_FALSE(fs::exists(path("new.json")));
  }
  ~CliAliases() override {
    for (const int descriptor : descriptors_)
      ::close(descriptor);
  }

  void try_inputs(const Line& line) {
    const std::string part = "is read by this command, name another file";
    for (const OutputOption& output : line.outputs) {
      for (const std::string& input : line.inputs) {
        // Every kind of name of the last input, links of the others.
        std::vector<std::string> names = names_of(input, output.ending);
        if (input != line.inputs.back()) names.resize(1);
        for (const std::string& name : names)
          expect_refused(with(line.words, {output.option, output.prefix + name}), part);
      }
    }
  }
  void try_pairs(const Line& line) {
    for (const OutputOption& a : line.outputs) {
      for (const OutputOption& b : line.outputs) {
        if (&a >= &b || (!a.ending.empty() && !b.ending.empty() && a.ending != b.ending)) continue;
        const std::string ending = a.ending + b.ending;
        for (const std::string& file : {"new" + ending, std::string("old")}) {
          if (file == "old" && !ending.empty()) continue;
          // Every kind of name of the first two, links of the others.
          std::vector<std::string> names = names_of(file, ending);
          if (&a != &line.outputs.front()) names.resize(1);
          for (const std::string& name : names)
            expect_refused(with(line.words, {a.option, a.prefix + path(file), b.option, b.prefix + name}),
                           "name the same file");
        }
      }
    }
  }

  fs::path folder_ = scratch_folder("aliases");
  std::map<fs::path, std::string> contents_;
  std::vector<int> descriptors_;
  std::set<std::string> programs_;  ///< commands that were also run with the program
  const OutputOption json_{"--json", "", ""}, csv_{"--csv", "", ""}, link_{"--link", "record:", ""},
      events_{"--events", "", ""}, vtu_{"--vtu", "", ""}, png_{"--png", "", ""}, out_{"--out", "", ""},
      html_{"--html", "", ""}, trace_{"--trace", "", ""}, rig_{"--write-rig", "", ""};
  const std::string log_ = "study/sub-1/beh/sub-1_task-shapes_run-1_events.tsv",
                    sidecar_ = "study/sub-1/beh/sub-1_task-shapes_run-1_events.json",
                    finger_ = "study/sub-1/beh/sub-1_task-shapes_run-1_recording-finger_physio.tsv.gz";

  std::vector<Line> lines() const {
    const std::string scene = path("scene.gltf"), points = path("finger.ply"), rig = path("rig.toml"),
                      layout = path("layout.toml"), drive = path("drive.csv");
    const std::vector<std::string> scene_files{"scene.gltf", "picture.png", "corners.bin"},
        rig_files{"mask.png", "layout.toml", "rig.toml"},
        take_files{"take/mask.png", "take/times.csv", "take/recording.toml", "take/depth-0.png"};
    const auto and_also = [](std::vector<std::string> all, const std::vector<std::string>& more) {
      all.insert(all.end(), more.begin(), more.end());
      return all;
    };
    const std::string bag = "bag:" + path("take.bag"), take = "recording:" + path("take");
    return {
        {{"doctor"}, {}, {json_, rig_}},
        {{"doctor", "--source", take}, take_files, {rig_}},
        {{"doctor", "--source", bag}, {"take.bag"}, {rig_}},
        {{"doctor", "--source", bag, "--write-rig", path("new")}, {"take.bag"}, {json_}},
        {{"touch", "--scene", scene, "--points", points, "--layout", layout},
         and_also(scene_files, {"finger.ply", "layout.toml"}),
         {json_, csv_}},
        {{"touch", "--scene", scene, "--depth", path("depth.png"), "--camera", path("camera.toml")},
         {"camera.toml", "depth.png"},
         {json_}},
        {{"touch", "--scene", scene, "--depth", path("depth.png"), "--rig", rig}, {"mask.png", "rig.toml"}, {json_}},
        {{"run", "--scene", scene, "--rig", rig}, and_also(scene_files, rig_files), {json_, events_, link_}},
        {{"run", "--scene", scene, "--layout", layout, "--source", take}, take_files, {json_, events_, link_}},
        {{"run", "--scene", scene, "--source", "synthetic:" + points}, {"finger.ply"}, {link_}},
        {{"run", "--scene", scene, "--layout", layout, "--source", take, "--transfer", "finger", "--finger", points},
         {"finger.ply"},
         {link_}},
        {{"run", "--scene", scene, "--layout", layout, "--source", bag}, {"take.bag"}, {json_, events_, link_}},
        {{"export", "--scene", scene, "--rig", rig, "--frames", "1", "--events", path("new")},
         {"layout.toml", "mask.png", "rig.toml"},
         {{"--drives", "", ""}}},
        {{"export", "--scene", scene, "--layout", layout, "--source", take, "--drives", path("new")},
         and_also(scene_files, take_files),
         {json_, events_, {"--foci", "", ".json"}}},
        {{"export", "--scene", scene, "--layout", layout, "--source", take, "--events", path("new")},
         take_files,
         {{"--drives", "", ""}}},
        {{"export", "--played", path("played.json"), "--layout", layout, "--drives", path("new")},
         {"played.json", "layout.toml"},
         {json_}},
        {{"export", "--played", path("played.json"), "--layout", layout},
         {"played.json", "layout.toml"},
         {{"--drives", "", ""}}},
        {{"link", "test", "--layout", layout}, {}, {json_, link_}},
        {{"link", "test", "--layout", layout}, {"layout.toml"}, {link_}},
        {{"link", "test", "--layout", layout, "--link", "null"}, {"layout.toml"}, {json_}},
        {{"run", "--scene", scene, "--link", "openmpd:NONE", "--board-files", path("boards")},
         {"boards/sonicsurface.txt", "boards/board_A.pat"},
         {json_, events_}},
        {{"link", "test", "--layout", layout, "--link", "sonicsurface:/dev/null", "--board-files", path("boards")},
         {"boards/sonicsurface.txt", "boards/board_A.pat"},
         {json_}},
        {{"calibrate", "--nudge", "--keys", "enter", "--rig", rig, "--scene", scene, "--link", "openmpd:NONE",
          "--board-files", path("boards"), "--out", path("new")},
         {"boards/board_A.pat"},
         {json_}},
        {{"calibrate", "--nudge", "--keys", "enter", "--rig", rig, "--scene", scene, "--link", "openmpd:NONE",
          "--board-files", path("boards")},
         {"boards/board_A.pat"},
         {out_}},
        {{"calibrate", "--rig", rig}, rig_files, {{"--target", "", ".stl"}}},
        {{"calibrate", "--rig", rig, "--layout", layout, "--source", bag}, {"layout.toml", "take.bag"}, {json_, out_}},
        {{"calibrate", "--rig", rig, "--source", take}, and_also(rig_files, take_files), {json_, out_}},
        {{"calibrate", "--nudge", "--keys", "enter", "--rig", rig, "--scene", scene, "--out", path("new")},
         and_also(rig_files, scene_files),
         {json_, link_}},
        {{"drive", "--layout", layout, "--rig", rig, "--touch", path("touch.json")},
         {"mask.png", "rig.toml", "layout.toml", "touch.json"},
         {json_, csv_}},
        {{"drive", "--layout", layout, "--pattern", path("pattern.toml")},
         {"layout.toml", "pattern.toml"},
         {json_, csv_}},
        {{"drive", "--layout", layout, "--focus", "0,0,0.1", "--transfer", "finger", "--force", "--mesh", scene},
         scene_files,
         {json_, csv_}},
        {{"field", "--layout", layout, "--drive", drive, "--points", points},
         {"layout.toml", "drive.csv", "finger.ply"},
         {json_, csv_, vtu_}},
        {{"field", "--layout", layout, "--drive", drive, "--plane", "xy", "--size", "1cm,1cm"},
         {"layout.toml", "drive.csv"},
         {png_, csv_}},
        {{"scatter", "--force", "--mesh", scene, "--plane-wave", "0,0,1", "--points", points},
         {"finger.ply"},
         {json_, csv_}},
        {{"scatter", "--force", "--mesh", scene, "--layout", layout, "--drive", drive},
         and_also({"layout.toml", "drive.csv"}, scene_files),
         {json_, csv_}},
        {{"simulate", "--scene", scene, "--finger", points, "--rig", rig},
         and_also(and_also(scene_files, rig_files), {"finger.ply"}),
         {json_, csv_, vtu_, png_}},
        {{"simulate", "--scene", scene, "--finger", points, "--layout", layout}, {"layout.toml"}, {json_, csv_}},
        {{"decompose", "--scene", scene}, {}, {json_, out_}},
        {{"decompose", "--scene", scene}, scene_files, {out_}},
        {{"decompose", "--scene", scene, "--out", path("new")}, scene_files, {json_}},
        {{"study", "analyse", path("study")}, {log_, sidecar_, finger_}, {json_, csv_, html_}},
        {{"study", "analyse", path("counts.csv")}, {"counts.csv"}, {json_, html_}},
        {{"study", "compare", "paper", path("counts.csv"), path("study")}, {log_, "counts.csv"}, {json_, csv_, html_}},
        {{"study", "power"}, {}, {json_, csv_, html_}},
        {{"study", "plan", path("study.toml")}, {"study.toml", "scene.gltf", "layout.toml"}, {json_, csv_}},
        {{"study", "level", path("study.toml")}, {"study.toml", "layout.toml"}, {json_}},
        {{"study", "rehearse", path("study.toml"), "--participant", "1", "--out", path("new")},
         {"study.toml", "scene.gltf"},
         {json_}},
        {{"study", "simulate", path("study.toml"), "--finger", points, "--beside", path("counts.csv")},
         {"study.toml", "scene.gltf", "layout.toml", "counts.csv", "finger.ply"},
         {json_, csv_, html_, {"--prediction", "", ""}}},
        {{"study", "withdraw", "7", "--out", path("study")}, {}, {json_}},
        {{"afferents", "--scene", scene, "--finger", points, "--layout", layout},
         and_also(scene_files, {"layout.toml", "finger.ply"}),
         {json_, csv_, png_, {"--times", "", ""}}},
        {{"bench", "--scene", scene}, scene_files, {json_, csv_}},
        {{"emulate", "openmpd", "--view", "--layout", layout}, {"layout.toml"}, {json_, trace_}},
        {{"emulate", "openmpd", "--view", "--board-files", path("boards")}, {"boards/board_A.pat"}, {trace_}},
        {{"emulate", "autd3", "--layout", layout}, {"layout.toml"}, {json_, trace_}},
        {{"emulate", "sonicsurface", "--layout", layout}, {"layout.toml"}, {json_, trace_}},
    };
  }
};

TEST_F(CliAliases, OfAnInputAreNoOutput) {
  for (const Line& line : every_third(lines()))
    try_inputs(line);
}

TEST_F(CliAliases, OfAnOutputAreNoOther) {
  for (const Line& line : every_third(lines()))
    try_pairs(line);
}

TEST_F(CliAliases, EveryOptionThatNamesAFileIsTried) {
  // Folders are tried in test_cli_recording.cpp. A sitting is another program's.
  const std::set<std::string> elsewhere{"run --record",     "study run --out", "study run --source",
                                        "study run --link", "study run --rig", "study run --board-files",
                                        "study run --json"};
  const std::vector<Line> all = lines();
  for (const std::string& command : every_command()) {
    std::set<std::string> tried;
    for (const Line& line : all) {
      if (!is_of(line.words, command)) continue;
      tried.insert(line.words.begin(), line.words.end());
      for (const OutputOption& output : line.outputs)
        tried.insert(output.option);
    }
    for (const HelpedOption& option : options_of(command)) {
      static const std::regex of_files("(^|[^A-Z])(FILE|DIR|LINK|SOURCE)($|[^A-Z])");
      if (!std::regex_search(option.type, of_files)) continue;
      const std::string name = command + " " + option.name;
      EXPECT_TRUE(tried.contains(option.name) || elsewhere.contains(name)) << name << " is not in the lines above";
    }
  }
}

}  // namespace
}  // namespace palpa::test
