// Every option of a live run on palpa-viewer's line reaches the run that it starts: the link gets something else
// than without it, and the same as by `palpa run`.
#include <gtest/gtest.h>

#include <fmt/format.h>

#include <atomic>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "support/begins.hpp"
#include "support/files.hpp"
#include "support/own_cache.hpp"
#include "support/shared_data.hpp"
#include "viewer/live/live_edit.hpp"
#include "viewer/live/live_line.hpp"
#include "viewer/live/live_session.hpp"
#include "viewer/options/viewer_options.hpp"

namespace palpa::viewer {
namespace {

/// The first plans of a run. A run that has given them ends, because it would play the last one for long.
constexpr int most_plans = 4;
struct Told {
  std::string text;
  std::atomic<int> plans{0};
};

/// Writes down what it gets, without what depends on when.
class ToldLink final : public session::Link {
 public:
  ToldLink(Told& told, const session::LinkSetting& setting) : told_(told) {
    told_.text = fmt::format("{} {} {} {} {} {} {}\n", setting.layout.name, setting.slot_s, setting.foci_move,
                             setting.sound_speed_m_s, setting.board_files, setting.steps, setting.free_field);
  }
  bool plays() const override { return false; }
  void plan(const session::PlayedPlan& plan) override {
    std::string text;
    for (std::uint32_t v = 0; v < plan.schedule.voice_count; ++v) {
      const array::Voice& voice = plan.schedule.voices[v];
      text += fmt::format("{} {} {} {} {};", voice.solid, voice.dwell_s, voice.gain, voice.modulation_hz,
                          static_cast<int>(voice.modulation));
      for (const Vec3& focus : voice.foci)
        text += fmt::format("{},{},{} ", focus.x, focus.y, focus.z);
      text += fmt::format("{}", fmt::join(voice.order, ","));
    }
    float sum = 0;
    for (std::size_t i = 0; i < plan.drives.size(); ++i)
      sum += plan.drives[i].amplitude * static_cast<float>(i % 13) + plan.drives[i].phase * static_cast<float>(i % 7);
    if (text.empty() || told_.plans == most_plans) return;
    told_.text += text + fmt::format(" drives {}\n", sum);
    ++told_.plans;
  }
  void send(std::uint64_t, std::span<const array::TransducerDrive>) override {}
  void finish() override {}

 private:
  Told& told_;
};

session::LinkKind told_link(Told& told) {
  return {.name = "told",
          .help = "",
          .open = [&told](const std::string&,
                          const session::LinkSetting& setting) { return std::make_unique<ToldLink>(told, setting); },
          .reads_board_files = true,
          .takes_steps = true};
}

/// A model of an L in two scenes at different places, with its inner edge under the recorded finger.
std::string ells() {
  static const std::string file = [] {
    const auto folder = test::scratch_folder("every-live-option");
    constexpr float outline[][2]{{-0.02F, -0.04F}, {0.02F, -0.04F}, {0.02F, -0.002F},
                                 {0, -0.002F},     {0, 0},          {-0.02F, 0}};
    constexpr std::uint16_t front[][3]{{0, 1, 3}, {1, 2, 3}, {0, 3, 4}, {0, 4, 5}};
    std::string bytes;
    const auto put = [&](const auto& value) { bytes.append(reinterpret_cast<const char*>(&value), sizeof(value)); };
    for (const float z : {-0.02F, 0.02F}) {
      for (const auto& [x, y] : outline)
        for (const float coordinate : {x, y, z})
          put(coordinate);
    }
    const auto face = [&](int a, int b, int c) {
      for (const int corner : {a, b, c})
        put(static_cast<std::uint16_t>(corner));
    };
    for (const auto& [a, b, c] : front) {
      face(c, b, a);
      face(a + 6, b + 6, c + 6);
    }
    for (int a = 0; a < 6; ++a) {
      const int b = (a + 1) % 6;
      face(a, b, b + 6);
      face(a, b + 6, a + 6);
    }
    test::write_text(folder / "ells.bin", bytes);
    test::write_text(folder / "ells.gltf", R"({"asset":{"version":"2.0"},"scenes":[{"nodes":[0]},{"nodes":[1]}],
      "scene":0,"nodes":[{"mesh":0},{"mesh":0,"translation":[0.003,-0.001,0]}],
      "meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}],
      "buffers":[{"uri":"ells.bin","byteLength":264}],
      "bufferViews":[{"buffer":0,"byteLength":144},{"buffer":0,"byteOffset":144,"byteLength":120}],
      "accessors":[{"bufferView":0,"componentType":5126,"count":12,"type":"VEC3","min":[-0.02,-0.04,-0.02],"max":[0.02,0,0.02]},
                   {"bufferView":1,"componentType":5123,"count":60,"type":"SCALAR"}]})");
    return (folder / "ells.gltf").string();
  }();
  return file;
}

using Words = std::vector<std::string>;

Words operator+(Words words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

line::Given given_of(const Words& words) {
  line::Given given;
  for (std::size_t i = 0; i < words.size(); ++i) {
    std::vector<std::string>& values = given[words[i]];
    while (i + 1 < words.size() && !words[i + 1].starts_with("--"))
      values.push_back(words[++i]);
  }
  return given;
}

std::string take() {
  return "recording:" + test::source_file("assets/depth/take").string();
}

/// The options of the run that the viewer starts with this line.
setup::LiveOptions options_of_run(const line::Given& given) {
  setup::LiveOptions options = LiveEdit(options_of(given).given).options();
  if (given.contains("--frames")) options.frames = std::stoul(given.at("--frames").front());
  return options;
}

/// What the link gets in that run: its first plans, or all if there are fewer.
std::string told_in(const setup::LiveOptions& options) {
  Told told;
  std::atomic<bool> stop{false};
  {
    LiveSession::Kinds kinds;
    kinds.links.push_back(told_link(told));
    LiveSession session(options, kinds, stop, [] {});
    EXPECT_TRUE(test::begins([&] { return session.over() || told.plans == most_plans; }));
    EXPECT_EQ(session.fault(), "");
  }
  return told.text;
}

struct Tried {
  Words value;
  Words line{};  ///< further options, with which it makes a difference
};

/// Boards emit 40 kHz only.
std::string bare_layout() {
  const std::filesystem::path file = test::scratch_folder("every-live-option-layout") / "bare.toml";
  test::write_text(file,
                   "[[transducer]]\nposition_m = [0, 0, 0]\naxis = [0, 0, 1]\n"
                   "[[transducer]]\nposition_m = [0.02, 0, 0]\naxis = [0, 0, 1]\n");
  return file.string();
}

std::map<std::string, Tried> tried() {
  const auto asset = [](const char* name) { return test::source_file(std::string("assets/") + name).string(); };
  const Words multi{"--scene", asset("prism.glb"), "--method", "multi-focus"};
  const Words single{"--method", "single-focus"}, l{"--scene", ells()}, parts = l + Words{"--surface", "parts"};
  const Words tune{"--tune", "--dwell", "0.8ms"}, synthetic{"--source", "synthetic", "--frames", "2"};
  return {{"--scene", {{asset("semi-sphere.glb")}}},
          {"--gltf-scene", {{"1"}, l}},
          {"--source", {{"synthetic"}, {"--frames", "2"}}},
          {"--surface", {{"parts"}, l}},
          {"--parts", {{"1"}, parts}},
          {"--internal-faces", {{"keep"}, parts}},
          {"--rig", {{asset("rigs/openmpd-one.toml")}, synthetic}},
          {"--layout", {{"sonicsurface"}}},
          {"--delta", {{"1mm"}}},
          {"--finger-gap", {{"0.1mm"}}},
          {"--min-points", {{"100000"}}},
          {"--foci", {{"7"}}},
          {"--spacing", {{"arc"}}},
          {"--stride", {{"1"}}},
          {"--dwell", {{"2ms"}}},
          {"--method", {{"ellipse"}}},
          {"--modulation", {{"amplitude-sine"}, single}},
          {"--modulation-frequency", {{"150Hz"}, single}},
          {"--tune", {{}, {"--dwell", "0.8ms"}}},
          {"--amplitude", {{"distance"}}},
          {"--solver", {{"greedy"}, multi}},
          {"--constraint", {{"normalise"}, multi}},
          {"--pressure", {{"500Pa"}}},
          {"--directivity", {{"omni"}, multi}},
          {"--temperature", {{"30"}}},
          {"--sound-speed", {{"350m/s"}}},
          {"--frequency", {{"41kHz"}, {"--layout", bare_layout()}}},
          {"--ceiling", {{"0.5"}}},
          {"--noise-free", {{}, synthetic}},
          {"--board-files", {{test::scratch_folder("every-live-option-boards").string()}}},
          {"--steps", {{"off"}}},
          {"--axes", {{"covariance"}}},
          {"--smoothing", {{"none"}}},
          {"--hysteresis", {{"off"}, multi}},
          {"--seed", {{"7"}, synthetic}}};
}

/// Options that change nothing that a link gets in such a run, or not the same each time, and the tests of them.
const std::map<std::string, std::string_view> others{
    {"--hold", "how long: test_live.cpp, test_loop.cpp"},
    {"--ramp", "in time: test_safe_link.cpp"},
    {"--spot", "its finger fits any spot"},
    {"--keep-boards", "needs an object near a board: test_cli_surroundings.cpp"},
    {"--finger-width", "needs fingers side by side: test_split.cpp"},
    {"--cluster", "needs a finger through a solid: test_inside.cpp"},
    {"--events", "a file: test_files.cpp"},
    {"--event-move", "of a file"},
    {"--link", "here it is told"},
    {"--every-frame", "without it, frames are left out"},
    {"--record", "a folder: test_live.cpp"},
    {"--overwrite", "of a folder"},
    {"--osc", "messages: test_live_edit.cpp"},
    {"--transfer", "needs a finger in its rig: test_live_fingers.cpp"},
    {"--finger", "of --transfer"},
    {"--null", "needs a place: test_nulls.cpp"},
    {"--predict", "in time: test_predict.cpp"},
    {"--predict-latency", "in time"},
    {"--allow-outside", "test_files.cpp"},
    {"--gpu", "another device: test_device.cpp"},
    {"--backend", "the same to rounding"},
    {"--validation", "for developers"},
};

TEST(EveryLiveOption, IsTriedOrKnown) {
  const std::map<std::string, Tried> table = tried();
  for (const line::OptionInfo& info : live_table())
    EXPECT_NE(table.contains(info.name), others.contains(info.name)) << info.name;
}

TEST(EveryLiveOption, OfTheViewerReachesItsRun) {
  const test::OwnCache cache(test::scratch_folder("every-live-option-cache"));  // solids are cut once
  // With a long hold, no frame is out of date before it sounds.
  const line::Given base =
      given_of({"--scene", test::source_file("assets/cube.glb").string(), "--source", take(), "--every-frame",
                "--backend", "cpu", "--layout", "openmpd", "--link", "told", "--hold", "1s"});
  std::map<line::Given, std::string> told;
  std::vector<std::pair<line::Given, line::Given>> pairs;
  for (const auto& [name, one] : tried()) {
    line::Given without = base;
    for (auto& [other, values] : given_of(one.line))
      without[other] = values;
    line::Given with = without;
    with[name] = one.value;
    told[without] = told[with] = "";
    pairs.emplace_back(without, with);
  }
  for (auto& [given, heard] : told)
    heard = told_in(options_of_run(given));
  EXPECT_EQ(told[base], told_in(options_of_run(base))) << "the same each time";
  for (const auto& [without, with] : pairs) {
    EXPECT_NE(told[with], told[without]) << line::command_line("palpa-viewer", live_table(), with) << "\n"
                                         << told[with].substr(0, 300);
  }
}

}  // namespace
}  // namespace palpa::viewer
