// No command overwrites its input, or one output with another, whatever they are called. All of this is rejected before
// any long work begins. Every kind of name of a file is tried in base/test_outputs.cpp, symbolic links here.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "cli/support/every_command.hpp"
#include "cli/support/here.hpp"
#include "cli/support/tiny_files.hpp"
#include "sensation/pattern_text.hpp"
#include "support/boards.hpp"
#include "support/files.hpp"
#include "support/instrumented.hpp"
#include "support/shared_data.hpp"
#include "support/study_files.hpp"

namespace palpa::test {
namespace {

namespace fs = std::filesystem;

/// Texts of words. IN/ is the test's folder, LOG the beginning of the names of a participant's files.
struct Line {
  std::string words;
  std::string inputs;  ///< files of that folder that these words name, or what those refer to
  /// Options that name a file that is written, and what the name needs: "--link=record:" before it, "--target=.stl" at
  /// its end.
  std::string outputs;
};

struct OutputOption {
  std::string option, prefix, ending;
};

class CliAliases : public testing::Test {
 protected:
  CliAliases() {
    write_tiny_files(folder_);
    fs::create_directories(folder_ / "boards");
    write_text(folder_ / "drive.csv", "index,x,y,z,nx,ny,nz,amplitude,phase\n0,0,0,-0.1,0,0,1,1,0\n");
    write_text(folder_ / "pattern.adaptics", PatternText{}.text());
    write_text(folder_ / "pattern.toml", "[[point]]\nposition_m = [0, 0, 0.1]\n");
    write_text(folder_ / "touch.json",
               R"({"fingers":[{"foci_m":[[0,0,0.1]]}],"schedule":{"order":[0],"dwell_s":0.0015}})");
    write_text(folder_ / "played.json",
               R"({"slot_s":0.0015,"frames":[{"slot":0,"time_s":0,"fingers":[{"id":0,"solid":"","foci_m":[[0,0,0.1]],)"
               R"("order":[0],"dwell_s":0.0015,"modulation_hz":0,"gain":1}]}]})");
    write_text(folder_ / "boards/board_A.pat", "A 256 128\n");
    write_text(folder_ / "boards" / serial_board_file(), "0\n");
    write_participant(folder_ / "study", 1, {{"m", 20}});
    write_text(folder_ / (log_ + "_recording-finger_physio.tsv.gz"), "not looked at before it is refused");
    write_text(folder_ / (log_ + "_recording-finger_physio.json"),
               R"({"SamplingFrequency": 50, "StartTime": 0, "Columns": ["depth"]})");
    write_text(folder_ / "counts.csv", "actual,cube,prism\ncube,3,1\nprism,1,3\n");
    write_text(folder_ / "take.bag", "#ROSBAG V2.0\n");
    write_text(folder_ / "study.toml",
               "[[shape]]\nname = \"a\"\nmodel = \"scene.gltf\"\n[[shape]]\nname = \"b\"\nmodel = \"scene.gltf\"\n"
               "[[method]]\nname = \"single-focus\"\nlayout = \"layout.toml\"\n"
               "[fit]\nmethod = \"single-focus\"\naccuracy = 0.6\ntrials = 30\n");
    contents_ = contents_of(folder_);
  }

  std::vector<std::string> words_of(const std::string& text) const {
    return test::words_of(text, {{"IN/", folder_ / ""}, {"LOG", log_}});
  }
  std::vector<OutputOption> outputs_of(const Line& line) const {
    std::vector<OutputOption> outputs;
    for (const std::string& word : words_of(line.outputs)) {
      const std::size_t end = std::min(word.find('='), word.size() - 1);
      const std::string rest = word.substr(end + 1);
      const bool is_ending = rest.starts_with('.');
      outputs.push_back({word.substr(0, word.find('=')), is_ending ? "" : rest, is_ending ? rest : ""});
    }
    return outputs;
  }

  /// Another name of a file, with that ending.
  std::string link_to(const std::string& file, const std::string& ending) const {
    const fs::path link = folder_ / ("soft" + ending);
    fs::remove(link);
    fs::create_symlink(folder_ / file, link);
    return link;
  }
  void expect_untouched(const std::vector<std::string>& words, const std::string& part) {
    SCOPED_TRACE(testing::PrintToString(words));
    expect_failure(palpa_here(words), 2, part);
    for (const auto& [file, text] : contents_)
      ASSERT_EQ(read_text(folder_ / file), text) << file;
    for (const char* name : {"new", "new.json", "new.stl"})
      ASSERT_FALSE(fs::exists(folder_ / name)) << "an output was created";
  }

  const fs::path folder_ = scratch_folder("aliases");
  const std::string log_ = "study/sub-1/beh/sub-1_task-shapes_run-1";
  std::map<std::string, std::string> contents_;
};

const std::string gltf = "scene.gltf picture.png corners.bin", rig = "mask.png layout.toml rig.toml",
                  filmed = "take/mask.png take/times.csv take/recording.toml take/depth-0.png",
                  boards = "boards/" + serial_board_file() + " boards/board_A.pat";
const std::vector<Line> lines{
    {"doctor", "", "--json --write-rig"},
    {"doctor --rig IN/rig.toml --layout IN/layout.toml", rig, "--json"},
    {"doctor --serial MPD0001", "", "--write-eeprom"},
    {"doctor --source recording:IN/take", filmed, "--write-rig"},
    {"doctor --source bag:IN/take.bag", "take.bag", "--write-rig"},
    {"doctor --source bag:IN/take.bag --write-rig IN/new", "take.bag", "--json"},
    {"touch --scene IN/scene.gltf --points IN/finger.ply --layout IN/layout.toml --audible",
     gltf + " finger.ply layout.toml", "--json --csv --wav"},
    {"touch --scene IN/scene.gltf --depth IN/depth.png --camera IN/camera.toml", "camera.toml depth.png", "--json"},
    {"touch --scene IN/scene.gltf --depth IN/depth.png --rig IN/rig.toml", "mask.png rig.toml", "--json"},
    {"run --scene IN/scene.gltf --rig IN/rig.toml", gltf + " " + rig, "--json --events --link=record:"},
    {"run --scene IN/scene.gltf --rig IN/rig.toml --layout autd3", "layout.toml", "--json"},
    {"run --scene IN/scene.gltf --layout IN/layout.toml --source recording:IN/take", filmed,
     "--json --events --link=record:"},
    {"run --scene IN/scene.gltf --source synthetic:IN/finger.ply", "finger.ply", "--link=record:"},
    {"run --scene IN/scene.gltf --layout IN/layout.toml --source recording:IN/take --transfer finger"
     " --finger IN/finger.ply",
     "finger.ply", "--link=record:"},
    {"run --scene IN/scene.gltf --layout IN/layout.toml --source bag:IN/take.bag", "take.bag",
     "--json --events --link=record:"},
    {"run --scene IN/scene.gltf --link openmpd:NONE --board-files IN/boards", boards, "--json --events"},
    {"play IN/pattern.adaptics --duration 1ms --layout IN/layout.toml", "pattern.adaptics layout.toml",
     "--json --csv --png --link=record:"},
    {"play IN/pattern.adaptics --duration 1ms --rig IN/rig.toml", "layout.toml rig.toml", "--json --csv"},
    {"play IN/pattern.adaptics --link openmpd:NONE --board-files IN/boards", "boards/board_A.pat", "--json"},
    {"play IN/pattern.adaptics --layout IN/layout.toml --on finger --scene IN/scene.gltf --source recording:IN/take",
     gltf + " " + filmed, "--json --link=record:"},
    {"export --scene IN/scene.gltf --rig IN/rig.toml --frames 1 --events IN/new", rig, "--drives"},
    {"export --scene IN/scene.gltf --layout IN/layout.toml --source recording:IN/take --drives IN/new",
     gltf + " " + filmed, "--json --events --foci=.json"},
    {"export --scene IN/scene.gltf --layout IN/layout.toml --source recording:IN/take --events IN/new", filmed,
     "--drives"},
    {"export --played IN/played.json --layout IN/layout.toml --drives IN/new", "played.json layout.toml", "--json"},
    {"export --played IN/played.json --layout IN/layout.toml", "played.json layout.toml", "--drives"},
    {"link test --layout IN/layout.toml", "layout.toml", "--link=record:"},
    {"link test --layout IN/layout.toml", "", "--json --link=record:"},
    {"link test --layout IN/layout.toml --link null", "layout.toml", "--json"},
    {"link test --layout IN/layout.toml --link " + serial_board() + ":/dev/null --board-files IN/boards", boards,
     "--json"},
    {"calibrate --nudge --keys enter --rig IN/rig.toml --scene IN/scene.gltf --link openmpd:NONE"
     " --board-files IN/boards --out IN/new",
     "boards/board_A.pat", "--json"},
    {"calibrate --nudge --keys enter --rig IN/rig.toml --scene IN/scene.gltf --link openmpd:NONE"
     " --board-files IN/boards",
     "boards/board_A.pat", "--out"},
    {"calibrate --nudge --keys enter --rig IN/rig.toml --scene IN/scene.gltf --out IN/new", rig + " " + gltf,
     "--json --link=record:"},
    {"calibrate --rig IN/rig.toml", rig, "--target=.stl"},
    {"calibrate --rig IN/rig.toml --layout IN/layout.toml --source bag:IN/take.bag", "layout.toml take.bag",
     "--json --out"},
    {"calibrate --rig IN/rig.toml --source recording:IN/take", rig + " " + filmed, "--json --out"},
    {"drive --layout IN/layout.toml --rig IN/rig.toml --touch IN/touch.json",
     "mask.png rig.toml layout.toml touch.json", "--json --csv"},
    {"drive --layout IN/layout.toml --pattern IN/pattern.toml", "layout.toml pattern.toml", "--json --csv"},
    {"drive --layout IN/layout.toml --focus 0,0,0.1 --transfer finger --force --mesh IN/scene.gltf", gltf,
     "--json --csv"},
    {"field --layout IN/layout.toml --drive IN/drive.csv --points IN/finger.ply", "layout.toml drive.csv finger.ply",
     "--json --csv --vtu"},
    {"field --layout IN/layout.toml --drive IN/drive.csv --plane xy --size 1cm,1cm", "layout.toml drive.csv",
     "--png --csv"},
    {"scatter --force --mesh IN/scene.gltf --plane-wave 0,0,1 --points IN/finger.ply", "finger.ply", "--json --csv"},
    {"scatter --force --mesh IN/scene.gltf --layout IN/layout.toml --drive IN/drive.csv",
     "layout.toml drive.csv " + gltf, "--json --csv"},
    {"simulate --scene IN/scene.gltf --finger IN/finger.ply --rig IN/rig.toml", gltf + " " + rig + " finger.ply",
     "--json --csv --vtu --png"},
    {"simulate --scene IN/scene.gltf --finger IN/finger.ply --layout IN/layout.toml", "layout.toml", "--json --csv"},
    {"decompose --scene IN/scene.gltf", "", "--json --out"},
    {"decompose --scene IN/scene.gltf", gltf, "--out"},
    {"decompose --scene IN/scene.gltf --out IN/new", gltf, "--json"},
    {"study analyse IN/study", "LOG_events.tsv LOG_events.json LOG_recording-finger_physio.tsv.gz",
     "--json --csv --html --script"},
    {"study analyse IN/counts.csv", "counts.csv", "--json --html --script"},
    {"study compare paper IN/counts.csv IN/study", "LOG_events.tsv counts.csv", "--json --csv --html --script"},
    {"study power", "", "--json --csv --html"},
    {"study plan IN/study.toml", "study.toml scene.gltf layout.toml", "--json --csv"},
    {"study level IN/study.toml", "study.toml layout.toml", "--json"},
    {"study rehearse IN/study.toml --participant 1 --out IN/new", "study.toml scene.gltf", "--json"},
    {"study simulate IN/study.toml --finger IN/finger.ply --beside IN/counts.csv",
     "study.toml scene.gltf layout.toml counts.csv finger.ply", "--json --csv --html --prediction"},
    {"study withdraw 7 --out IN/study", "", "--json"},
    {"afferents --scene IN/scene.gltf --finger IN/finger.ply --layout IN/layout.toml", gltf + " layout.toml finger.ply",
     "--json --csv --png --times"},
    {"bench --scene IN/scene.gltf", gltf, "--json --csv"},
    {"emulate openmpd --view --layout IN/layout.toml", "layout.toml", "--json --trace"},
    {"emulate openmpd --view --board-files IN/boards", "boards/board_A.pat", "--trace"},
    {"emulate autd3 --layout IN/layout.toml", "layout.toml", "--json --trace"},
    {"emulate " + serial_board() + " --layout IN/layout.toml", "layout.toml", "--json --trace"},
};

TEST_F(CliAliases, OfAnInputAreNoOutput) {
  for (const Line& line : every_third(lines)) {
    for (const OutputOption& output : outputs_of(line)) {
      for (const std::string& input : words_of(line.inputs))
        expect_untouched(with(words_of(line.words), {output.option, output.prefix + link_to(input, output.ending)}),
                         "is read by this command, name another file");
    }
  }
}

TEST_F(CliAliases, OfAnOutputAreNoOther) {
  for (const Line& line : every_third(lines)) {
    const std::vector<OutputOption> outputs = outputs_of(line);
    for (const OutputOption& a : outputs) {
      for (const OutputOption& b : outputs) {
        if (&a >= &b || (!a.ending.empty() && !b.ending.empty() && a.ending != b.ending)) continue;
        const std::string ending = a.ending + b.ending, file = "new" + ending;
        expect_untouched(with(words_of(line.words), {a.option, a.prefix + (folder_ / file).string(), b.option,
                                                     b.prefix + link_to(file, ending)}),
                         "name the same file");
      }
    }
  }
}

TEST_F(CliAliases, EveryOptionThatNamesAFileIsTried) {
  // Folders are tried in test_cli_recording.cpp. A sitting is another program's.
  const std::set<std::string> elsewhere{"run --record",     "study run --out", "study run --source",
                                        "study run --link", "study run --rig", "study run --board-files",
                                        "study run --json"};
  for (const std::string& command : every_command()) {
    std::set<std::string> tried;
    for (const Line& line : lines) {
      const std::vector<std::string> words = words_of(line.words);
      if (!is_of(words, command)) continue;
      tried.insert(words.begin(), words.end());
      for (const OutputOption& output : outputs_of(line))
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
