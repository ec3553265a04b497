// `palpa run` with few pixels: --events and --hold of a recording whose touches can be worked out by hand, and a source
// that a room above the engine adds, such as a camera's.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <sstream>
#include <string>
#include <vector>

#include "cli/commands.hpp"
#include "cli/support/heard_drives.hpp"
#include "cli/support/here.hpp"
#include "cli/support/process.hpp"
#include "geometry/gltf/write.hpp"
#include "sensing/recording.hpp"
#include "support/boards.hpp"
#include "support/files.hpp"
#include "support/json.hpp"
#include "support/shapes.hpp"
#include "support/shared_data.hpp"

namespace palpa::test {
namespace {

using nlohmann::json;

constexpr double near_m = 0.3;  // the button's front face, seen from the camera at the origin
constexpr double focal = 300;   // a pixel is a millimetre there
constexpr int centre = 16;
constexpr double unit_m = 1e-4;

/// The file of a box whose front face fills the picture.
std::string button(const std::filesystem::path& folder, std::optional<double> press_depth_m) {
  geometry::SceneMesh mesh{"button", box({-0.1, -0.1, near_m}, {0.1, 0.1, 0.4})};
  mesh.haptics.press_depth_m = press_depth_m;
  geometry::write_glb(folder / "button.glb", std::span(&mesh, 1));
  return folder / "button.glb";
}

/// A fingertip of five by five pixels: its rim and its middle, so many tenths of a millimetre below the button's face.
struct Tip {
  int u = 0, rim = 0, middle = 0;
  int depth(int du, int dv) const { return std::max(std::abs(du), std::abs(dv)) == 2 ? rim : middle; }
};

sensing::FrameSet frame_of(const Tip& tip, int n, double time_s) {
  sensing::FrameSet set;
  set.frames.resize(1);
  std::vector<std::uint16_t>& depth = set.frames[0].depth;
  depth.assign(32 * 32, 0);
  for (int dv = -2; tip.rim != 0 && dv <= 2; ++dv) {
    for (int du = -2; du <= 2; ++du)
      depth[static_cast<std::size_t>((centre + dv) * 32 + tip.u + du)] =
          static_cast<std::uint16_t>(std::lround(near_m / unit_m)) + static_cast<std::uint16_t>(tip.depth(du, dv));
  }
  set.sequence = static_cast<std::uint64_t>(n);
  set.frames[0].time_s = set.time_s = time_s;
  return set;
}

/// The mean of the tip's points in the shell of 1.5 mm.
Vec3 centroid_of(const Tip& tip) {
  Vec3 sum(0);
  int count = 0;
  for (int dv = -2; dv <= 2; ++dv) {
    for (int du = -2; du <= 2; ++du) {
      const double z = near_m + unit_m * tip.depth(du, dv);
      if (tip.depth(du, dv) >= 15) continue;
      sum += Vec3((tip.u + du - centre) * z / focal, dv * z / focal, z);
      ++count;
    }
  }
  return sum / static_cast<double>(count);
}

const Tip nothing{}, light{16, 5, 5}, aside{17, 5, 5}, deep{17, 10, 35}, other{10, 5, 5};

sensing::Camera eye() {
  sensing::Camera camera{
      .name = "eye", .width = 32, .height = 32, .fx = focal, .fy = focal, .cx = centre, .cy = centre};
  camera.depth_unit_m = unit_m;
  return camera;
}

/// Frames 10 ms apart, and one much later: by then it is another finger.
std::filesystem::path take(const std::filesystem::path& folder) {
  sensing::RecordingWriter writer(folder / "take", {eye()});
  int n = 0;
  for (const Tip& tip : {nothing, light, light, aside, deep, nothing, deep, aside, nothing, nothing, nothing, nothing,
                         nothing, nothing}) {
    writer.write(frame_of(tip, n, 0.01 * n));
    ++n;
  }
  writer.write(frame_of(other, n, 1.0));
  return folder / "take";
}

struct Wanted {
  const char* event;
  double time_s;
  int touch;  ///< which, counted from 0: fingers of different touches have different ids
  double depth_m;
  Tip tip;
};
const std::vector<Wanted> wanted{{"touch", 0.01, 0, 0.0005, light}, {"move", 0.03, 0, 0.0005, aside},
                                 {"move", 0.04, 0, 0.0035, deep},   {"press", 0.04, 0, 0.0035, deep},
                                 {"move", 0.07, 0, 0.0005, aside},  {"release", 0.12, 0, 0.0005, aside},
                                 {"touch", 1.0, 1, 0.0005, other},  {"release", 1.0, 1, 0.0005, other}};

void expect_wanted(const std::string& text) {
  std::istringstream in(text);
  std::vector<json> lines;
  for (std::string line; std::getline(in, line);)
    lines.push_back(json::parse(line));
  ASSERT_EQ(lines.size(), wanted.size()) << text;
  for (std::size_t i = 0; i < wanted.size(); ++i) {
    const json& line = lines[i];
    EXPECT_EQ(line["event"], wanted[i].event) << i;
    EXPECT_NEAR(line["time_s"].get<double>(), wanted[i].time_s, 1e-9) << i;
    EXPECT_EQ(line["solid"], "button");
    EXPECT_NEAR(line["depth_m"].get<double>(), wanted[i].depth_m, 1e-6) << i;
    const Vec3 centroid = centroid_of(wanted[i].tip);
    for (int axis = 0; axis < 3; ++axis)
      EXPECT_NEAR(line["centroid_m"][static_cast<std::size_t>(axis)].get<double>(), centroid[axis], 2e-6) << i;
    EXPECT_EQ(line["finger"] == lines[0]["finger"], wanted[i].touch == 0) << i;
    EXPECT_EQ(line.size(), 6U);
  }
}

struct Stage {
  std::filesystem::path folder = scratch_folder("events");
  std::string scene = button(folder, 0.003);
  std::string source = "recording:" + take(folder).string();

  std::vector<std::string> run(const std::vector<std::string>& more) const {
    return with({"run", "--scene", scene, "--source", source, "--every-frame"}, more);
  }
};

TEST(CliEvents, ARecordingGivesTheEventsThatWereWorkedOut) {
  const Stage stage;
  const Result gpu = succeeded(palpa_here(stage.run({"--backend", "gpu", "--events", "-"})));
  EXPECT_EQ(gpu.err_without_lateness(), "");
  expect_wanted(gpu.out);
  const auto file = stage.folder / "events.jsonl";
  const Result cpu =
      succeeded(palpa_here(stage.run({"--backend", "cpu", "--events", file.string(), "--stats", "json"})));
  expect_wanted(read_text(file));
  EXPECT_EQ(json::parse(cpu.out)["events"], (json{{"written", 8}, {"dropped", 0}}));

  const auto moves = [&](const char* least) {
    const std::string out = palpa_here(stage.run({"--backend", "cpu", "--events", "-", "--event-move", least})).out;
    std::size_t count = 0;
    for (std::size_t at = 0; (at = out.find("\"move\"", at)) != std::string::npos; ++at)
      ++count;
    return count;
  };
  EXPECT_EQ(moves("0"), 5U) << "in touching frames after the first: 2, 3, 4, 6 and 7";
  EXPECT_EQ(moves("10mm"), 0U);
}

TEST(CliHold, IsHowLongATouchSoundsOnceFramesStop) {
  const auto folder = scratch_folder("hold");
  const std::string scene = button(folder, {});
  sensing::RecordingWriter(folder / "one", {eye()}).write(frame_of(light, 0, 0));
  // Slots from the second drive that sounds to the last one. The first may bear the slot for which a late output woke
  // up, which began before the frame came.
  const auto sounding = [&](const std::string& hold) {
    const std::string drives = (folder / ("drives" + hold)).string();
    succeeded(palpa_here({"run", "--scene", scene, "--source", "recording:" + (folder / "one").string(), "--backend",
                          "cpu", "--layout", on_off_board(), "--every-frame", "--hold", hold, "--link",
                          "record:" + drives, "--quiet"}));
    std::vector<std::uint64_t> slots;
    for (const RecordedDrive& recorded : read_to_silence(drives).drives) {
      if (loudest(recorded.drive) > 0) slots.push_back(recorded.slot);
    }
    return slots.size() < 2 ? 0.0 : 1.5e-3 * static_cast<double>(slots.back() - slots[1]);
  };
  // A slow machine may be late with the first drive, never with the last one.
  EXPECT_LE(sounding("30ms"), 0.030 + 2 * 1.5e-3);
  const double longer = sounding("2s");
  EXPECT_LE(longer, 2 + 2 * 1.5e-3);
  EXPECT_GT(longer, 0.3);
}

/// Looks down on the cube's face at y = 0 from 0.3 m above; a pixel sees 3 mm of it.
sensing::Camera above() {
  sensing::Camera camera{.name = "above", .width = 9, .height = 9, .fx = 100, .fy = 100, .cx = 4, .cy = 4};
  camera.depth_unit_m = 1e-4;
  camera.T_world_camera = Transform(1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 0.3, 0, 1);
  return camera;
}

/// Frames at given times, all of the same depths.
struct Given final : sensing::DepthSource {
  std::vector<sensing::Camera> rig{above()};
  std::vector<double> times_s;
  std::uint16_t depth = 0;
  std::size_t given = 0;

  const std::vector<sensing::Camera>& cameras() const override { return rig; }
  bool next(sensing::FrameSet& out, double) override {
    if (given == times_s.size()) return false;
    out.frames.resize(1);
    out.frames[0].depth.assign(std::size_t{rig[0].width} * rig[0].height, depth);
    out.frames[0].time_s = out.time_s = times_s[given];
    out.sequence = given++;
    return true;
  }
};

Result run_given(const std::vector<double>& times_s, std::uint16_t depth, const std::vector<std::string>& more) {
  const auto add_source = [&](cli::Extensions& extensions) {
    extensions.sources.push_back(
        {"given", "given  frames of the test's", [&](const std::string&, const session::SourceSetting&) {
           auto source = std::make_unique<Given>();
           source->times_s = times_s;
           source->depth = depth;
           return source;
         }});
  };
  return palpa_here(
      with({"run", "--scene", source_file("assets/cube.glb"), "--source", "given", "--stats", "json", "--every-frame"},
           more),
      {}, add_source);
}

TEST(CliSources, AClockThatStepsBackEndsNoRecording) {
  const auto folder = scratch_folder("steps-back") / "take";
  const Result outcome =
      succeeded(run_given({10, 10.01, 0, 0.01, 10.02}, 0, {"--backend", "cpu", "--record", folder.string()}));
  EXPECT_EQ(outcome.err_without_lateness(),
            "palpa: warning: the source's capture times run backwards (from 10.010 s to 0.000 s): they "
            "have to ascend evenly\npalpa: warning: " +
                folder.string() + ": 2 of 5 frames are missing, because the source's clock stepped back\n");
  const auto stats = json::parse(outcome.out);
  EXPECT_EQ(stats["frames"]["planned"], 5);
  EXPECT_EQ(stats["frames"]["unrecorded"], 2);
  EXPECT_EQ(sensing::load_recording(folder).entries.size(), 3u);
}

TEST(CliSources, FingersThatAreTooManyAreToldOnce) {
  // Half a millimetre below the face, each of the 81 pixels a finger.
  for (const char* backend : {"cpu", "gpu"}) {
    const Result outcome = succeeded(run_given(
        {0, 0.01, 0.02}, 3005,
        {"--min-points", "1", "--finger-gap", "1mm", "--finger-width", "0", "--hold", "1s", "--backend", backend}));
    EXPECT_EQ(outcome.err_without_lateness(),
              "palpa: warning: 17 of 81 clusters of contacts are left out: palpa uses at most 64 of a frame\n");
    EXPECT_EQ(json::parse(outcome.out)["frames"]["touching"], 3) << backend;
  }
  const Result one = run_given({0, 0.01}, 3005, {"--min-points", "1", "--backend", "cpu"});
  EXPECT_EQ(one.err_without_lateness(), "");
  EXPECT_EQ(json::parse(one.out)["frames"]["touching"], 2);
}

}  // namespace
}  // namespace palpa::test
