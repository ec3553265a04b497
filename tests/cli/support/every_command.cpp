#include "cli/support/every_command.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <sstream>

#include "cli/support/process.hpp"
#include "geometry/files/ply.hpp"
#include "geometry/mesh/icosphere.hpp"
#include "support/files.hpp"
#include "support/shapes.hpp"
#include "support/shared_data.hpp"
#include "support/study_files.hpp"

namespace palpa::test {

std::vector<std::string> every_command() {
  std::vector<std::string> commands;
  std::istringstream help(palpa({"--help"}).out);
  bool listed = false;
  for (std::string line; std::getline(help, line);) {
    if (line == "Subcommands:") {
      listed = true;
    } else if (line.empty()) {
      listed = false;
    } else if (listed) {
      // A name may have two words. The summary follows after several spaces.
      commands.push_back(line.substr(2, line.find("  ", 2) - 2));
    }
  }
  EXPECT_GE(commands.size(), 16u);
  return commands;
}

std::vector<std::string> as_words(const std::string& command) {
  std::istringstream words(command);
  return {std::istream_iterator<std::string>(words), {}};
}

bool is_of(const std::vector<std::string>& line, const std::string& command) {
  const std::vector<std::string> words = as_words(command);
  return line.size() >= words.size() && std::equal(words.begin(), words.end(), line.begin());
}

std::vector<HelpedOption> options_in(const std::string& help) {
  std::vector<HelpedOption> options;
  std::istringstream lines(help);
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("  --")) continue;
    HelpedOption option;
    std::istringstream words(line);
    words >> option.name;
    // A type follows after one space, the help after several.
    if (line.size() > option.name.size() + 3 && line[option.name.size() + 3] != ' ') words >> option.type;
    options.push_back(option);
  }
  return options;
}

std::vector<HelpedOption> options_of(const std::string& command) {
  const std::string page = palpa({"help", command, "all"}).out;
  std::vector<HelpedOption> options = options_in(page);
  const std::size_t common = page.rfind("Common options (palpa help all):");
  EXPECT_NE(common, std::string::npos) << command;
  if (common == std::string::npos) return options;
  std::istringstream words(page.substr(common));
  std::vector<std::string> named(std::istream_iterator<std::string>(words), {});
  for (const HelpedOption& option : options_in(palpa({"help", "all"}).out)) {
    if (std::ranges::find(named, option.name) != named.end()) options.push_back(option);
  }
  return options;
}

QuickLines::QuickLines() : folder_(scratch_folder("quick-lines")), cache_(folder_ / "cache") {
  const std::string scene = source_file("assets/cube.glb"), finger = source_file("assets/finger.ply");
  const std::string pebble = folder_ / "pebble.ply", tip = folder_ / "tip.ply", recording = folder_ / "recording";
  const geometry::Mesh ball = geometry::icosphere(1e-3, 4);
  geometry::write_ply(pebble, ball.positions, ball.triangles);
  const geometry::Mesh rounded_tip =
      transformed(geometry::icosphere(2e-3, 4), [](const Vec3& p) { return p + Vec3(0, 2e-3, 0); });
  geometry::write_ply(tip, rounded_tip.positions, rounded_tip.triangles);
  // The observer's finger, with which the shapes of its plan can be told apart.
  const std::string fingertip = folder_ / "fingertip.ply";
  const geometry::Mesh round = transformed(sphere(2e-3, 8, 12), [](const Vec3& p) { return p + Vec3(0, 2e-3, 0); });
  geometry::write_ply(fingertip, round.positions, round.triangles);
  const Result recorded = palpa(with(
      {"run", "--scene", scene, "--frames", "3", "--every-frame", "--backend", "cpu", "--record", recording, "--quiet"},
      small_frames()));
  EXPECT_EQ(recorded.exit_code, 0) << recorded.err;
  write_participant(folder_ / "study", 1, {{"single-focus", 18}, {"cross-section", 28}});
  std::filesystem::create_directories(folder_ / "withdrawn/sub-02");
  write_text(folder_ / "level.toml",
             "[[shape]]\nname = \"a\"\nmodel = \"palpa:cube.glb\"\n[[shape]]\nname = \"b\"\n"
             "model = \"palpa:prism.glb\"\n[[method]]\nname = \"single-focus\"\nlayout = \"openmpd\"\n"
             "[level]\nceiling = 0.05\n");
  write_small_plan(folder_ / "study-plan.toml", scene, source_file("assets/prism.glb"));
  lines_ = {
      {"doctor", {"doctor", "--backend", "cpu"}},
      {"touch", {"touch", "--scene", scene, "--points", finger, "--penetration", "3mm", "--backend", "cpu"}},
      {"run",
       {"run", "--scene", scene, "--source", "recording:" + recording, "--frames", "3", "--every-frame", "--hold",
        "10ms", "--backend", "cpu"}},
      {"export",
       {"export", "--scene", scene, "--source", "recording:" + recording, "--backend", "cpu", "--foci",
        folder_ / "foci.csv"}},
      {"link",
       {"link", "test", "--layout", "openmpd", "--link", "null", "--each", "1ms", "--rest", "0", "--last", "1"}},
      {"calibrate", {"calibrate", "--rig", source_file("tests/cli/support/small_rig.toml"), "--frames", "2"}},
      {"drive", {"drive", "--layout", "openmpd", "--focus", "0,0,100mm", "--backend", "cpu"}},
      {"field",
       {"field", "--layout", "openmpd", "--focus", "0,0,100mm", "--plane", "xz", "--size", "20mm,20mm", "--pixels",
        "4,4", "--backend", "cpu"}},
      {"scatter", {"scatter", "--mesh", pebble, "--point-source", "0,0,100mm", "--backend", "cpu"}},
      {"simulate",
       {"simulate", "--scene", scene, "--finger", tip, "--penetration", "1mm", "--layout", "openmpd", "--backend",
        "cpu"}},
      {"afferents",
       {"afferents", "--scene", scene, "--finger", tip, "--penetration", "1mm", "--layout", "openmpd", "--duration",
        "20ms", "--backend", "cpu"}},
      {"decompose", {"decompose", "--scene", scene, "--out", folder_ / "parts.glb"}},
      {"study analyse", {"study", "analyse", folder_ / "study"}},
      {"study compare", {"study", "compare", "paper"}},
      {"study level", {"study", "level", folder_ / "level.toml"}},
      {"study plan", {"study", "plan", source_file("assets/studies/five-minutes.toml")}},
      {"study power", {"study", "power", "--people", "8", "--studies", "100"}},
      {"study rehearse",
       {"study", "rehearse", source_file("assets/studies/five-minutes.toml"), "--participant", "1", "--out",
        folder_ / "rehearsed"}},
      {"study run",
       {"study", "run", source_file("assets/studies/five-minutes.toml"), "--participant", "1", "--out", folder_ / "run",
        "--rehearse", "1"}},
      {"study simulate", {"study", "simulate", folder_ / "study-plan.toml", "--finger", fingertip}},
      {"study withdraw", {"study", "withdraw", "2", "--out", folder_ / "withdrawn"}},
      {"bench", {"bench", "--suite", "links", "--runs", "3"}},
      {"emulate", {"emulate", "autd3", "--port", "0"}},
  };
}

std::vector<std::string> QuickLines::of(const std::string& command) const {
  const auto found = lines_.find(command);
  if (found != lines_.end()) return found->second;
  ADD_FAILURE() << command << " has no quick line here: add one";
  return {command};
}

std::vector<std::string> without(std::vector<std::string> line, const std::string& option) {
  const auto at = std::ranges::find(line, option);
  if (at == line.end()) return line;
  const auto end = std::find_if(at + 1, line.end(), [](const std::string& word) { return word.starts_with("--"); });
  line.erase(at, end);
  return line;
}

}  // namespace palpa::test
