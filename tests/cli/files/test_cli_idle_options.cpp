// No option is ignored silently. Each option of each command is in the list of options that were checked and always
// have an effect, or is rejected if it has none: a new option needs one of the two. (--layout beside --rig is no
// exception: it replaces the rig's array, as each --help says.)
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "cli/support/here.hpp"
#include "cli/support/process.hpp"
#include "support/shared_data.hpp"

namespace palpa::test {
namespace {

/// Without `beside`, a line that would run with it.
struct Idle {
  std::vector<std::string> given;  ///< the option first
  std::string told;
};

struct Command {
  std::vector<std::string> line;  ///< that lacks nothing
  std::string effective;          ///< options that do something beside any such line
  std::vector<Idle> idle;
};

std::string asset(const std::string& name) {
  return source_file("assets/" + name).string();
}

std::vector<std::string> words_of(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> words;
  for (std::string word; in >> word;)
    words.push_back(word);
  return words;
}

/// The options that a command's help lists.
std::set<std::string> options_of(const std::string& command) {
  const std::string page = palpa_here({"help", command, "all"}).out;
  std::istringstream help(page);
  std::set<std::string> options;
  for (std::string line; std::getline(help, line);) {
    if (line.starts_with("  --")) options.insert(words_of(line)[0]);
  }
  for (const std::string& word : words_of(page.substr(page.rfind("Common options (")))) {
    if (word.starts_with("--")) options.insert(word);
  }
  return options;
}

/// A line without a GPU's options takes --backend and --seed wherever a program might: nothing is computed on a GPU,
/// and nothing is random there.
const char* const common = "--backend --json --quiet --log-level --seed --allow-outside ";
const char* const touch_options =
    "--delta --finger-gap --min-points --cluster --spacing --stride --dwell --method --modulation "
    "--modulation-frequency --tune ";
const char* const drive_options =
    "--amplitude --solver --constraint --pressure --directivity --temperature --sound-speed --frequency ";

const std::vector<Idle> no_gpu{{{"--gpu", "0"}, "--gpu: --backend cpu uses no GPU"},
                               {{"--validation", "core"}, "--validation: --backend cpu uses no GPU"}};
const std::vector<Idle> parts{{{"--parts", "3"}, "--parts goes with --surface parts"},
                              {{"--internal-faces", "keep"}, "--internal-faces goes with --surface parts"}};

std::vector<Idle> joined(const std::vector<std::vector<Idle>>& lists) {
  std::vector<Idle> all;
  for (const auto& list : lists)
    all.insert(all.end(), list.begin(), list.end());
  return all;
}

std::vector<Idle> no_gpu_at_all(const std::string& why) {
  return {{{"--gpu", "0"}, why}, {{"--validation", "core"}, why}};
}

std::vector<Command> commands() {
  const std::string cube = asset("cube.glb"), finger = asset("finger.ply");
  const std::vector<Idle> places{{{"--centre", "0,0,0"}, "go with --plane"},
                                 {{"--size", "6mm,6mm"}, "go with --plane"},
                                 {{"--pixels", "8,8"}, "go with --plane"},
                                 {{"--samples", "9"}, "--samples goes with --line"}};
  const std::vector<Idle> felt{{{"--spot", "4mm"}, "--spot goes with"},
                               {{"--tune-shortest", "1ms"}, "go together"},
                               {{"--tune-longest", "2ms"}, "go together"},
                               {{"--tune-shortest", "1ms", "--tune-longest", "2ms"}, "go with --tune"}};
  const std::vector<Idle> live{{{"--event-move", "1mm"}, "--event-move goes with --events"},
                               {{"--noise-free", "--source", "recording:none"}, "--noise-free goes with"},
                               {{"--spot", "4mm"}, "--spot goes with --tune"}};
  const std::string run_options = std::string(touch_options) + drive_options +
                                  "--scene --gltf-scene --source --frames --hold --ceiling --ramp --events --surface "
                                  "--rig --layout --finger-width --axes --smoothing ";
  return {
      {{"doctor"},
       "--write-rig",
       joined({{{{"--source", "bag:x"}, "--source goes with --write-rig"}},
               no_gpu_at_all("palpa doctor looks at every GPU")})},
      {{"touch", "--scene", cube, "--points", finger, "--backend", "cpu"},
       std::string(touch_options) + "--scene --gltf-scene --points --depth --penetration --csv --surface --foci "
                                    "--spectrum --layout",
       joined({no_gpu,
               parts,
               felt,
               {{{"--camera", "x.toml"}, "go with --depth"},
                {{"--rig", "x.toml"}, "go with --depth"},
                {{"--finger-width", "10mm"}, "--finger-width goes with --depth"},
                {{"--amplitude", "uniform"}, "go with --layout"},
                {{"--solver", "greedy"}, "go with --layout"},
                {{"--constraint", "clamp"}, "go with --layout"},
                {{"--pressure", "1kPa"}, "go with --layout"},
                {{"--directivity", "omni"}, "go with --layout"},
                {{"--temperature", "25"}, "go with --layout"},
                {{"--sound-speed", "350m/s"}, "go with --layout"},
                {{"--frequency", "41kHz"}, "go with --layout"}}})},
      {{"run", "--scene", cube, "--backend", "cpu", "--frames", "1"},
       run_options + "--foci --link --every-frame --record --stats",
       joined({no_gpu,
               parts,
               live,
               {{{"--overwrite"}, "--overwrite goes with --record"},
                {{"--board-files", "/"}, "--board-files goes with a link to boards"}}})},
      {{"export", "--scene", cube, "--backend", "cpu", "--frames", "1", "--foci", "-"},
       run_options + "--foci --foci-count --drives",
       joined({no_gpu, parts, live})},
      {{"link", "test", "--link", "null", "--layout", "openmpd", "--last", "0", "--each", "1ms", "--rest", "0"},
       "--link --layout --first --last --each --rest --dwell --amplitude",
       joined({{{{"--board-files", "/"}, "--board-files goes with a link to boards"}},
               no_gpu_at_all("palpa link uses no GPU")})},
      {{"calibrate", "--layout", "openmpd"},
       "--target --at --turn --source --frames --noise-free --out --rig --layout --nudge",
       joined({no_gpu_at_all("palpa calibrate computes on the processor"),
               {{{"--scene", cube}, "--scene goes with --nudge"},
                {{"--link", "foci:udp:127.0.0.1:9"}, "--link goes with --nudge"},
                {{"--board-files", "/"}, "--board-files goes with --nudge"},
                {{"--keys", "enter"}, "--keys goes with --nudge"},
                {{"--hold", "50ms"}, "--hold goes with --nudge"},
                {{"--ceiling", "0.5"}, "--ceiling goes with --nudge"},
                {{"--ramp", "10ms"}, "--ramp goes with --nudge"},
                {{"--temperature", "25"}, "goes with --nudge"},
                {{"--sound-speed", "350m/s"}, "goes with --nudge"},
                {{"--frequency", "41kHz"}, "goes with --nudge"}}})},
      {{"calibrate", "--layout", "openmpd", "--target", "none/t.stl"},
       "",
       joined({no_gpu_at_all("palpa calibrate --target uses no GPU"),
               {{{"--source", "synthetic"}, "--target only writes the model"},
                {{"--frames", "3"}, "--target only writes the model"},
                {{"--noise-free"}, "--target only writes the model"},
                {{"--json", "-"}, "--target only writes the model"},
                {{"--out", "x.toml"}, "--target only writes the model"},
                {{"--nudge"}, "--target only writes the model"},
                {{"--keys", "enter"}, "--keys goes with --nudge"},
                {{"--at", "0,0,1mm"}, "a printer's .stl lies as it is printed"},
                {{"--turn", "90"}, "a printer's .stl lies as it is printed"}}})},
      {{"drive", "--layout", "openmpd", "--focus", "0,0,10cm", "--backend", "cpu"},
       std::string(drive_options) + "--layout --focus --touch --csv --transfer",
       joined({no_gpu,
               {{{"--slot", "1"}, "--slot goes with --touch"},
                {{"--rig", "x.toml"}, "--rig goes with --touch"},
                {{"--mesh", finger}, "--mesh goes with --transfer finger"},
                {{"--force"}, "--force goes with --transfer finger"}}})},
      {{"drive", "--layout", "openmpd", "--touch", "x.json", "--backend", "cpu"},
       "",
       {{{"--focus", "0,0,10cm"}, "exclude each other"}}},
      {{"field", "--layout", "openmpd", "--focus", "0,0,10cm", "--line", "0,0,1cm", "0,0,2cm", "--backend", "cpu"},
       std::string(drive_options) +
           "--layout --drive --focus --plane --line --points --samples --csv --vtu --no-absorption --humidity "
           "--air-pressure",
       joined({no_gpu,
               {{{"--centre", "0,0,0"}, "go with --plane"},
                {{"--size", "6mm,6mm"}, "go with --plane"},
                {{"--pixels", "8,8"}, "go with --plane"},
                {{"--png", "x.png"}, "--png draws a plane"},
                {{"--humidity", "20", "--no-absorption"}, "--humidity sets how much air absorbs"},
                {{"--air-pressure", "90kPa", "--no-absorption"}, "--air-pressure sets how much air absorbs"}}})},
      {{"scatter", "--mesh", finger, "--plane-wave", "0,0,1"},
       "--mesh --force --plane-wave --point-source --plane --line --points --csv --temperature --sound-speed "
       "--frequency --humidity --air-pressure",
       joined({places,
               no_gpu_at_all("palpa scatter computes on the processor"),
               {{{"--layout", "openmpd"}, "go together"},
                {{"--drive", "x.csv"}, "exclude each other"},
                {{"--directivity", "omni"}, "--directivity goes with --drive"},
                {{"--absorption"}, "--absorption goes with --drive"}}})},
      {{"simulate", "--scene", cube, "--finger", finger, "--penetration", "3mm", "--backend", "cpu"},
       std::string(touch_options) + drive_options +
           "--scene --gltf-scene --finger --penetration --skin --figure6 --force --csv --vtu --png --surface --foci "
           "--spectrum --rig --layout --transfer --humidity --air-pressure --no-absorption",
       joined({no_gpu,
               felt,
               parts,
               {{{"--noise-free"}, "--noise-free goes with --skin cameras"},
                {{"--finger-width", "10mm"}, "--finger-width goes with --skin cameras"}}})},
      {{"simulate", "--figure6", "--backend", "cpu"},
       "",
       {{{"--scene", cube}, "--figure6 computes the paper's objects"},
        {{"--gltf-scene", "0"}, "--figure6 computes the paper's objects"},
        {{"--csv", "x.csv"}, "--figure6 computes the paper's objects"},
        {{"--vtu", "x.vtu"}, "--figure6 computes the paper's objects"},
        {{"--method", "ellipse"}, "--figure6 computes the paper's objects"},
        {{"--surface", "parts"}, "go with --scene"},
        {{"--parts", "3"}, "go with --scene"}}},
      {{"decompose", "--scene", cube, "--out", "none/x.glb"},
       "--scene --gltf-scene --out --parts --resolution --error",
       no_gpu_at_all("palpa decompose computes on the processor")},
      {{"bench", "--suite", "array"},
       "--suite --runs --csv --gpu --validation",
       {{{"--scene", cube}, "--scene goes with --suite surface"}, {{"--backend", "cpu"}, "bench measures the GPU"}}},
      {{"emulate", "openmpd", "--serial", "IDLE1"},
       "--serial --uart --trace --view",
       joined({{{{"--port", "0"}, "--port goes with autd3, not with openmpd"},
                {{"--tactile"}, "--tactile goes with sonicsurface, not with openmpd"},
                {{"--layout", "openmpd"}, "--layout goes with --view"},
                {{"--board-files", "/"}, "--board-files goes with --view"}},
               no_gpu_at_all("palpa emulate uses no GPU")})},
      {{"emulate", "autd3", "--port", "0"},
       "--port --layout",
       {{{"--uart"}, "--uart goes with openmpd, not with autd3"},
        {{"--serial", "A"}, "--serial goes with openmpd, not with autd3"},
        {{"--tactile"}, "--tactile goes with sonicsurface, not with autd3"},
        {{"--board-files", "/"}, "--board-files goes with openmpd and sonicsurface, not with autd3"}}},
      {{"emulate", "sonicsurface"},
       "--tactile --layout",
       {{{"--uart"}, "--uart goes with openmpd, not with sonicsurface"},
        {{"--serial", "A"}, "--serial goes with openmpd, not with sonicsurface"},
        {{"--port", "1"}, "--port goes with autd3, not with sonicsurface"},
        {{"--board-files", "/"}, "--board-files goes with --view"}}},
  };
}

TEST(IdleOptions, AreRefused) {
  std::set<std::string> programs;
  for (const Command& command : commands()) {
    for (const Idle& idle : command.idle) {
      SCOPED_TRACE(command.line[0] + " " + idle.given[0]);
      const std::vector<std::string> line = with(command.line, idle.given);
      expect_failure(palpa_here(line), 2, idle.told);
      // Also run one line of each command with the program itself.
      if (!programs.insert(command.line[0]).second) continue;
      RunOptions options;
      options.timeout_s = 20;
      expect_failure(palpa(line, options), 2, idle.told);
    }
  }
}

TEST(IdleOptions, EveryOptionWasLookedAt) {
  std::set<std::string> names;
  for (const Command& command : commands())
    names.insert(command.line[0]);
  for (const std::string& name : names) {
    std::set<std::string> reviewed;
    for (const Command& command : commands()) {
      if (command.line[0] != name) continue;
      for (const std::string& option : words_of(common + command.effective))
        reviewed.insert(option);
      for (const Idle& idle : command.idle)
        reviewed.insert(idle.given[0]);
    }
    for (const std::string& option : options_of(name))
      EXPECT_TRUE(reviewed.contains(option)) << "palpa " << name << " " << option << ": where has it no effect?";
  }
  const std::string help = palpa_here({"--help"}).out;
  for (const std::string& name : names)
    EXPECT_NE(help.find("\n  " + name + " "), std::string::npos) << name;
}

}  // namespace
}  // namespace palpa::test
