// Lines that palpa refuses because of their words or of a small file that they name: one line of error, and its exit
// code. What is refused beside other options: files/test_cli_every_option.cpp. What is out of range:
// files/test_cli_limits.cpp.
#include <gtest/gtest.h>

#include <filesystem>
#include <iterator>
#include <string>
#include <tuple>
#include <vector>

#include "cli/support/boxes.hpp"
#include "cli/support/here.hpp"
#include "cli/support/process.hpp"
#include "geometry/files/ply.hpp"
#include "geometry/gltf/write.hpp"
#include "geometry/mesh/icosphere.hpp"
#include "support/files.hpp"
#include "support/shapes.hpp"
#include "support/shared_data.hpp"
#include "support/tracked_hands.hpp"

namespace palpa::test {
namespace {

/// Texts of words: a line, and what is added to it.
struct RefusedLine {
  std::string line;
  struct Added {
    std::string words, told;
    int code = 2;
  };
  std::vector<Added> all;
};

class Refusals : public testing::Test {
 protected:
  Refusals() {
    write_text(in("touch.json"), touch_of(R"({"foci_m": [[0, 0, 0], [0.01, 0, 0]]})"));
    write_text(in("loud.json"), touch_of(R"({"foci_m": [[0, 0, 0]]}, {"foci_m": [[0, 0, 0]], "asked_pa": 500})"));
    write_text(in("no-foci.json"), R"({"fingers": []})");
    write_text(in("foci.json"), R"({"slot_s": 0.0015, "frames": [{"slot": 3, "time_s": 1, "fingers": []}]})");
    write_text(in("bare.toml"), "[[transducer]]\nposition_m = [0, 0, 0]\naxis = [0, 0, 1]\n");
    write_text(in("pattern.toml"), "[[point]]\nposition_m = [0, 0, 0.15]\namplitude = -1\n");
    write_text(in("hands.jsonl"), line_of({1, {}}) + "\n");
    write_text(in("bad.jsonl"), line_of({1, {}}) + "\nhand\n");
    write_text(in("flat.toml"),
               "[joints]\nT_world_joints = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 2, 0], [0, 0, 0, 1]]\n");
    write_text(in("key.toml"), "[joints]\nT_world_camera = [[1, 0, 0, 0]]\n");
    write_text(in("single.csv"), "actual,a,b\na,3,1\nb,0,1\n");
    write_text(in("bad.csv"), "actual,a,b\na,1,-1\nb,0,1\n");
    write_ball("ball.ply", geometry::icosphere(5e-3, 6), 0);
    write_ball("tip.ply", geometry::icosphere(5e-3, 5), 5e-3);
    // Blunt fingers, 24 mm long: the tip above the origin, and too fine.
    for (const auto& [name, divisions, raised] :
         {std::tuple("raised.ply", 14, 5e-3), std::tuple("fine.ply", 19, 0.0)}) {
      const geometry::Mesh mesh = geometry::icosphere(8e-3, divisions);
      write_ball(name, transformed(mesh, [](const Vec3& p) { return p * Vec3(1, 1.5, 1); }), 12e-3 + raised);
    }
    geometry::SceneMesh asking = make_box({"right", {}, {0, 1, 0}, {1, 0, 0}, 0.01, 0.01, 0.01});
    asking.haptics.pressure_pa = 5e3;
    geometry::write_glb(in("asking.glb"), std::vector{asking});
  }

  std::string in(const std::string& name) const { return (folder_ / name).string(); }
  void write_ball(const std::string& name, const geometry::Mesh& mesh, double up) const {
    const geometry::Mesh moved = transformed(mesh, [&](const Vec3& p) { return p + Vec3(0, up, 0); });
    geometry::write_ply(in(name), moved.positions, moved.triangles);
  }
  static std::string touch_of(const std::string& fingers) {
    return R"({"fingers": [)" + fingers + R"(], "schedule": {"order": [0], "dwell_s": 0.0015}})";
  }
  void expect(const std::vector<RefusedLine>& lines) const {
    const auto files = [&] { return std::distance(std::filesystem::directory_iterator(folder_), {}); };
    const auto before = files();
    const Names names{{"CUBE", source_file("assets/cube.glb")},
                      {"FINGER", source_file("assets/finger.ply")},
                      {"RIG", source_file("tests/cli/support/small_rig.toml")},
                      {"IN/", folder_ / ""}};
    for (const auto& [line, all] : lines) {
      for (const auto& [words, told, code] : all) {
        SCOPED_TRACE(line + " " + words);
        expect_failure(palpa_here(words_of(line + " " + words, names)), code, told);
      }
    }
    EXPECT_EQ(files(), before) << "an output was begun";
  }

  const std::filesystem::path folder_ = scratch_folder("refused");
};

/// Which contradict each other, with each command that has both.
const std::string varied = " --spread temperature=2 --sound-speed 343";
const std::string on_cube = "touch --backend cpu --scene CUBE --points FINGER --penetration 3mm",
                  board = "drive --backend cpu --layout openmpd", focus = " --focus 0,0,150mm";

TEST_F(Refusals, OfATouchSayWhatIsWrong) {
  expect({{on_cube,
           {{"--delta 0", "--delta"},
            {"--stride 5", "give a stride such as"},
            {"--method loud", "multi-focus"},
            {"--modulation square", "pressure-sine"},
            {"--tune --tune-shortest 1ms", "--tune-longest"},
            {"--tune --tune-shortest 2ms --tune-longest 1ms", "tenth"},
            {"--depth d.png --camera c.toml", "--depth"},
            {"--layout nowhere", "nowhere", 4},
            {"--gltf-scene 7", "cube.glb", 4}}},
          {"touch --points FINGER", {{"", "--scene"}}},
          {"touch --scene CUBE",
           {{"", "--points"},
            {"--points FINGER --penetration deep", "--penetration"},
            {"--depth d.png", "--camera"},
            {"--depth d.png --camera c.toml --penetration 3mm", "--penetration"},
            {"--depth d.png --camera c.toml --rig r.toml", "--rig"}}}});
}

TEST_F(Refusals, OfADriveSayWhatIsWrong) {
  const std::string radius = "radius from 0 to 5mm", who = "finger 1 of " + in("loud.json") + " asks for a pressure";
  std::string many;
  for (int i = 0; i < 65; ++i)
    many += " --null " + std::to_string(i) + "mm,2cm,150mm";
  expect({{board,
           {{"", "--focus"},
            {"--focus 0,0", "x,y,z"},
            {"--focus a,b,c", "x,y,z"},
            {"--focus 0,0,1e999", "x,y,z"},
            {"--focus 0,0,0.1kHz", "x,y,z"},
            {"--focus 0,0,0.1,1.5", "at most 1"},
            {"--focus 0,0,0.1,-1", "at most 1"},
            {"--focus 0,0,0.1,", "at most 1"},
            {"--focus 0,0,1e6", "100 m"},
            {"--focus -78.75mm,78.75mm,0", "transducer 0"},
            {"--pattern IN/pattern.toml", in("pattern.toml") + ": line 3", 4},
            // A user who gave no --null does not read of it.
            {"--pattern carter", "--pattern carter: null "}}},
          {board + focus,
           {{"--temperature 20 --sound-speed 343", "--sound-speed"},
            {varied, "--spread varies it"},
            {"--null 1,2", "x,y,z"},
            {"--null 0,2cm,0.15,-1mm", radius},
            {"--null 0,2cm,0.15,6mm", radius},
            {"--null 0,0,1e6", "100 m"},
            {"--null 0,2cm,-20cm", "lies behind the array"},
            {"--null 0,2cm,3", "m from the nearest transducer"},
            {"--null -78.75mm,78.75mm,0", "transducer 0"},
            {"--null 0,0,150mm", "null 1 is 0.00 mm from focus 1, closer than the array resolves"},
            {"--null 2cm,0,150mm --null 0,4.9mm,150mm,5mm", "focus 1 is within null 2, 4.90 mm from its centre"},
            {"--null 0,0,160mm", "closer than the array resolves"},  // along the board's axis
            {"--null 0,2cm,0.15 --solver greedy", "--null goes with --solver gs-pat"},
            {"--null 0,2cm,0.15 --pressure 500Pa", "--null: --pressure sets how loud foci are"},
            {"--null 0,2cm,0.15 --transfer finger --mesh FINGER", "leave --transfer finger out"},
            {many, "65 nulls are more than the 64"},
            {"--transfer finger", "--mesh is missing"},
            {"--solver adjoint", "--mesh is missing"},
            {"--mesh IN/ball.ply --solver adjoint --transfer free", "leave --transfer free"},
            {"--mesh nothing.ply --transfer finger", "nothing.ply", 4},
            {"--mesh IN/ball.ply --transfer finger", "stands in the array", 4}}},
          {"drive --backend cpu --layout paper",
           {{"--pattern carter --solver naive", "--pattern carter goes with --solver gs-pat"},
            {"--touch IN/loud.json --constraint normalise", "--constraint: " + who},
            {"--touch IN/loud.json --solver greedy", "--solver greedy: " + who}}},
          {"drive --backend cpu",
           {{"--focus 0,0,0.1", "--layout"},
            {"--focus 0,0,0.1 --layout nowhere", "openmpd-pair", 4},
            {"--touch IN/touch.json", "--touch needs an array: give --layout, or the --rig"}}}});
}

TEST_F(Refusals, OfWhatIsComputedFromADriveSayWhatIsWrong) {
  const std::string field = "field --layout openmpd" + focus, plane = " --plane xz --size 12mm,30mm",
                    tip = "simulate --backend cpu --scene CUBE --finger IN/tip.ply";
  expect(
      {{field,
        {{"", "no place to look at: give --plane"},
         {plane + " --drive x.csv", "exclude each other"},
         {plane + " --transfer finger", "has no option '--transfer'"},
         {"--plane xy", "--plane has no extent: give --size"},
         {plane + varied, "--spread varies it"},
         {"--plane xy --size 0,10mm", "--size: '0,10mm' is not W,H"},
         {"--plane xy --size 10mm,10mm --pixels 0,5", "--pixels: '0,5'"},
         {"--plane xy --size 10mm,10mm --samples 5", "--samples goes with --line"},
         {"--line 0,0,0.1", "--line"},
         {"--line 0,0,0.1 0,0,200", "farther than 100 m"},
         {"--plane xy --size 1,1 --pixels 65536,65536", "a field of 4294967296 points needs 687.2 GB of memory", 1}}},
       {"field" + plane,
        {{focus, "--layout is missing"},
         {"--layout autd3", "nothing sounds: give --drive FILE.csv, or --focus"},
         {"--layout autd3 --drive x.csv --solver greedy", "exclude each other"},
         {"--layout autd3 --drive no.csv", "no.csv", 4}}},
       {"simulate",
        {{"--finger IN/tip.ply", "--scene is missing"},
         {"--scene CUBE", "--finger is missing"},
         {"--scene CUBE --finger FINGER --null 2cm,0,0", "--null"}}},
       {tip,
        {{"--layout openmpd --penetration 153mm", "stands in the array", 4},
         {"--layout openmpd" + varied, "--spread varies it"}}},
       {"afferents", {{"", "--scene is missing"}, {"--scene CUBE --foci 10 --stride 5", "--stride"}}},
       {"afferents --scene CUBE --finger IN/tip.ply --layout openmpd --method single-focus --duration 0.2",
        {{"--x 0.5", "touches nothing", 4}, {"--bin 1", "--bin is longer than --duration"}}}});
}

TEST_F(Refusals, OfARunSayWhatIsWrong) {
  const std::string asks = "\"right\" asks for a pressure", hands = " --source joints:IN/hands.jsonl ",
                    cameras = " goes with depth cameras", no_images = "has no depth images";
  expect(
      {{"run", {{"", "--scene is missing"}, {"--scene none.glb", "none.glb", 4}}},
       {"run --backend cpu --scene CUBE",
        {{"--source telepathy", "unknown source 'telepathy'"},
         {"--source recording:IN/", "recording.toml", 4},
         {"--source joints", "needs a port or a file"},
         {"--source joints:udp:0", "joints:udp:9000"},
         {"--source joints:udp:127.0.0.1", "joints:udp:9000"},
         {"--source joints:udp:192.0.2.1:9000 --link openmpd:ABSENT", "cannot listen", 1},
         {"--source joints:none.jsonl", "none.jsonl", 4},
         {"--source joints:IN/bad.jsonl", "bad.jsonl: line 2: ", 4},
         {hands + "--rig IN/flat.toml", "T_world_joints", 4},
         {hands + "--rig IN/key.toml", "T_world_joints", 4},
         {hands + "--finger-width 20mm", "--finger-width" + cameras},
         {hands + "--hysteresis on", "--hysteresis" + cameras},
         {hands + "--keep-boards", "--keep-boards" + cameras},
         {hands + "--transfer finger", "--transfer finger" + cameras},
         {hands + "--record IN/new", "--record" + cameras},
         {hands + "--noise-free", "--noise-free goes with --source synthetic"},
         {"--link piano", "unknown link 'piano'"},
         {"--layout autd3 --frequency 45kHz", "--frequency: the boards of autd3 emit 40 kHz only"},
         {"--layout openmpd --link record:IN/new --method single-focus --modulation-frequency 267Hz",
          "drives of 1.5 ms are too long for a modulation of 267 Hz: give a --dwell of at most 1.5ms, or a modulation "
          "of at most 267Hz"},
         {"--method single-focus --modulation-frequency 0.005", "0.005 Hz is too slow; give at least 0.01Hz"},
         {"--frames 1 --link foci:udp:127.0.0.1:9 --null 2cm,0,0", "link foci sends foci and no drives"},
         {"--hold auto --every-frame", "--every-frame"},
         {"--hold autumn", "'autumn' is not a time"},
         {"--rig none.toml", "none.toml", 4},
         {"--layout none", "none", 4},
         {"--pressure 8kPa --constraint normalise", "--constraint"},
         {"--pressure 8kPa --solver greedy", "greedy"}}},
       {"run --scene IN/asking.glb", {{"--constraint clamp", asks}, {"--solver greedy", asks}}},
       {"run --scene CUBE --frames 1 --transfer finger",
        {{"--predict auto", "they are not predicted"},
         {"--predict-latency 20ms", "they are not predicted"},
         {"--every-frame", "--every-frame cannot have it"},
         {"--finger IN/raised.ply", "a finger's tip must be at the origin", 4},
         {"--finger IN/fine.ply", "take too long to follow a finger with", 4},
         {"--finger none.ply", "none.ply", 4}}},
       {"export",
        {{"--frames 2 --foci IN/new.csv", "--scene is missing"},
         {"--played IN/no-foci.json --drives -", "not a file of foci", 4},
         {"--played IN/foci.json --layout sonicsurface --frequency 41kHz --drives IN/new", "emit 40 kHz only"},
         {"--played IN/no-foci.json", "--played goes with --drives"}}},
       {"export --backend cpu --scene CUBE",
        {{"--frames 2", "give --foci, --events or --drives"},
         {"--foci IN/new.csv", "does not end: give --frames"},
         {"--frames 1 --layout openmpd --frequency 45kHz --drives IN/new", "boards of openmpd emit 40 kHz only"},
         {"--frames 1 --layout autd3 --drives IN/new --method multi-focus --dwell 3ms",
          "drives of 3 ms are too long for a modulation of 200 Hz: give a --dwell of at most 2ms"},
         {"--source joints:udp:9000 --foci IN/new.csv", "does not end"},
         {"--frames 2 --foci IN/new", ".csv or .json"},
         {"--frames 1 --foci - --hold auto", "palpa run"},
         {"--frames 1 --drives - --solver adjoint", "this command has no finger's mesh"},
         {"--frames 1 --events - --layout IN/bare.toml --keep-boards", "has no boards to keep"}}},
       {"calibrate",
        {{"--at 1,2", "--at"},
         {"--frames 101", "--frames"},
         {"--rig RIG --source recording:IN/ --noise-free", "--noise-free goes with"},
         {"--rig RIG --out IN/new", "--source"},
         {"--rig RIG" + hands, no_images},
         {"--background --rig RIG" + hands, no_images},
         {"--background --rig RIG --frames 5", "a background is learned from 10 to 1000"},
         {"--target IN/new.obj", ".stl or .glb"},
         {"--nudge --keys enter", "--out is missing"},
         {"--nudge --out IN/new --keys rigth", "unknown key 'rigth'"},
         {"--nudge --out IN/new --keys enter --at 0,0,0", "--at"},
         {"--nudge --out IN/new --keys enter --scene CUBE" + hands, "--scene goes with cameras"}}},
       {"doctor --write-rig IN/new", {{hands, "give recording:DIR or bag:FILE"}}}});
}

TEST_F(Refusals, OfAStudySayWhatIsWrong) {
  expect({{"study analyse",
           {{"", "give palpa study analyse the folder of a study, or a CSV file of counts"},
            {"IN/none", "no such file", 4},
            {"IN/", "has no participants", 4},
            {"IN/single.csv IN/", "single.csv: is not a folder", 4},
            {"IN/bad.csv", "bad.csv: line 2: '-1' is not a count", 4}}},
          {"study compare",
           {{"", "at least two tables"},
            {"IN/single.csv", "one table alone cannot be compared"},
            {"paper IN/none.json", "none.json: no such file", 4}}},
          {"study power", {{"--studies 20000 --trials 1000", "is more than 400 million"}}}});
}

}  // namespace
}  // namespace palpa::test
