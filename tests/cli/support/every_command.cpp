#include "cli/support/every_command.hpp"

#include <fmt/ranges.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <iterator>
#include <map>
#include <set>
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

bool is_of(const std::vector<std::string>& line, const std::string& command) {
  const std::vector<std::string> words = words_of(command);
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

std::vector<std::string> odd_values(const std::string& type, const std::string& odd) {
  static const std::map<std::string, std::vector<std::string>> examples{{"X,Y,Z", {"10mm", "10mm", "10mm"}},
                                                                        {"X,Y,Z[,A]", {"10mm", "10mm", "10mm", "1"}},
                                                                        {"X,Y,Z[,R]", {"10mm", "10mm", "10mm", "1mm"}},
                                                                        {"W,H", {"10mm", "10mm"}},
                                                                        {"N,M", {"4", "4"}}};
  static const std::set<std::string> numbers{
      "LENGTH",  "TIME",    "FREQUENCY", "SPEED",     "PRESSURE",       "NUMBER",     "N",  "A",       "CELSIUS",
      "PERCENT", "DEGREES", "PART",      "TIME|auto", "FREQUENCY|auto", "SPEED|auto", "DB", "DECIBELS"};
  if (numbers.contains(type)) return {odd};
  const auto parts = examples.find(type);
  if (parts == examples.end()) return {};
  std::vector<std::string> values;
  for (std::size_t i = 0; i < parts->second.size(); ++i) {
    std::vector<std::string> value = parts->second;
    value[i] = odd;
    values.push_back(fmt::format("{}", fmt::join(value, ",")));
  }
  return values;
}

QuickLines::QuickLines() : folder_(scratch_folder("quick-lines")), cache_(folder_ / "cache") {
  const std::string scene = source_file("assets/cube.glb");
  names_ = {{"CUBE", scene},
            {"FINGER", source_file("assets/finger.ply")},
            {"SMALL", source_file("tests/cli/support/small_rig.toml")},
            {"STUDIES/", source_file("assets/studies/")},
            {"IN/", folder_ / ""}};
  const auto write = [&](const char* name, const geometry::Mesh& mesh, double up) {
    const geometry::Mesh moved = transformed(mesh, [&](const Vec3& p) { return p + Vec3(0, up, 0); });
    geometry::write_ply(folder_ / name, moved.positions, moved.triangles);
  };
  write("pebble.ply", geometry::icosphere(1e-3, 4), 0);
  write("tip.ply", geometry::icosphere(2e-3, 4), 2e-3);
  // The observer's finger, with which the shapes of its plan can be told apart.
  write("fingertip.ply", sphere(2e-3, 8, 12), 2e-3);
  succeeded(palpa(with({"run", "--scene", scene, "--frames", "3", "--every-frame", "--backend", "cpu", "--record",
                        folder_ / "recording", "--quiet"},
                       small_frames())));
  write_participant(folder_ / "study", 1, {{"single-focus", 18}, {"cross-section", 28}});
  std::filesystem::create_directories(folder_ / "withdrawn/sub-02");
  write_text(folder_ / "level.toml",
             "[[shape]]\nname = \"a\"\nmodel = \"palpa:cube.glb\"\n[[shape]]\nname = \"b\"\n"
             "model = \"palpa:prism.glb\"\n[[method]]\nname = \"single-focus\"\nlayout = \"openmpd\"\n"
             "[level]\nceiling = 0.05\n");
  write_small_plan(folder_ / "plan.toml", scene, source_file("assets/prism.glb"));
}

std::vector<std::string> QuickLines::of(const std::string& command) const {
  const std::string aim = " --layout openmpd --focus 0,0,100mm --backend cpu",
                    tip = " --scene CUBE --finger IN/tip.ply --penetration 1mm --layout openmpd --backend cpu",
                    replay = " --scene CUBE --source recording:IN/recording --backend cpu";
  const std::vector<std::string> lines{"doctor --backend cpu",
                                       "touch --scene CUBE --points FINGER --penetration 3mm --backend cpu",
                                       "run --frames 3 --every-frame --hold 10ms" + replay,
                                       "play point --duration 10ms --csv IN/point.csv",
                                       "export --foci IN/foci.csv" + replay,
                                       "link test --layout openmpd --link null --each 1ms --rest 0 --last 1",
                                       "calibrate --rig SMALL --frames 2",
                                       "drive" + aim,
                                       "field --plane xz --size 20mm,20mm --pixels 4,4" + aim,
                                       "scatter --mesh IN/pebble.ply --point-source 0,0,100mm --backend cpu",
                                       "simulate" + tip,
                                       "afferents --duration 20ms" + tip,
                                       "decompose --scene CUBE --out IN/parts.glb",
                                       "study analyse IN/study",
                                       "study compare paper",
                                       "study level IN/level.toml",
                                       "study plan STUDIES/five-minutes.toml",
                                       "study power --people 8 --studies 100",
                                       "study rehearse STUDIES/five-minutes.toml --participant 1 --out IN/rehearsed",
                                       "study run STUDIES/five-minutes.toml --participant 1 --out IN/run --rehearse 1",
                                       "study simulate IN/plan.toml --finger IN/fingertip.ply",
                                       "study withdraw 2 --out IN/withdrawn",
                                       "bench --suite links --runs 3",
                                       "emulate autd3 --port 0"};
  for (const std::string& line : lines) {
    if (is_of(words_of(line), command)) return words_of(line, names_);
  }
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
