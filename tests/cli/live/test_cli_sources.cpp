// palpa run with a source that a room above the engine adds, such as a camera's.
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "cli/commands.hpp"
#include "cli/support/here.hpp"
#include "cli/support/process.hpp"
#include "sensing/recording.hpp"
#include "support/json.hpp"
#include "support/shared_data.hpp"

namespace palpa::test {
namespace {

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
  const Result outcome = run_given({10, 10.01, 0, 0.01, 10.02}, 0, {"--backend", "cpu", "--record", folder.string()});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.err,
            "palpa: warning: the source's capture times run backwards (from 10.010 s to 0.000 s): they "
            "have to ascend evenly\npalpa: warning: " +
                folder.string() + ": 2 of 5 frames are missing, because the source's clock stepped back\n");
  const auto stats = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(stats["frames"]["planned"], 5);
  EXPECT_EQ(stats["frames"]["unrecorded"], 2);
  EXPECT_EQ(sensing::load_recording(folder).entries.size(), 3u);
}

TEST(CliSources, FingersThatAreTooManyAreToldOnce) {
  // Half a millimetre below the face, each of the 81 pixels a finger.
  for (const char* backend : {"cpu", "gpu"}) {
    const Result outcome = run_given(
        {0, 0.01, 0.02}, 3005,
        {"--min-points", "1", "--finger-gap", "1mm", "--finger-width", "0", "--hold", "1s", "--backend", backend});
    ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(outcome.err,
              "palpa: warning: 17 of 81 clusters of contacts are left out: palpa uses at most 64 of a frame\n");
    EXPECT_EQ(nlohmann::json::parse(outcome.out)["frames"]["touching"], 3) << backend;
  }
  const Result one = run_given({0, 0.01}, 3005, {"--min-points", "1", "--backend", "cpu"});
  EXPECT_EQ(one.err, "");
  EXPECT_EQ(nlohmann::json::parse(one.out)["frames"]["touching"], 2);
}

}  // namespace
}  // namespace palpa::test
