// A run in which nothing touched says why.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "cli/support/here.hpp"
#include "geometry/gltf/write.hpp"
#include "setup/sessions/kept_frames.hpp"
#include "support/files.hpp"
#include "support/shapes.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"

namespace palpa::test {
namespace {

using nlohmann::json;

/// A recording of a finger on the cube.
const std::filesystem::path& cube_frames() {
  static const std::filesystem::path take = [] {
    const std::filesystem::path made = scratch_folder("untouched") / "take";
    const Result record = succeeded(palpa_here({"run", "--scene", source_file("assets/cube.glb").string(), "--frames",
                                                "5", "--every-frame", "--backend", "cpu", "--record", made.string()}));
    EXPECT_EQ(record.out.find("nothing touched"), std::string::npos) << "the finger touched";
    return made;
  }();
  return take;
}

/// A run of them with another object.
Result run_of_cube_frames(const std::filesystem::path& folder, const Box& object) {
  const geometry::SceneMesh mesh{"low", box(object.low, object.high)};
  geometry::write_glb(folder / "low.glb", std::span(&mesh, 1));
  return palpa_here({"run", "--scene", (folder / "low.glb").string(), "--source", "recording:" + cube_frames().string(),
                     "--every-frame", "--backend", "cpu", "--json", (folder / "stats.json").string()});
}

TEST(Untouched, ARunSaysHowFarTheSkinWas) {
  const auto folder = scratch_folder("untouched-run");
  const Result below = succeeded(run_of_cube_frames(folder, {{-0.02, -0.12, -0.02}, {0.02, -0.08, 0.02}}));
  const json stats = json::parse(read_text(folder / "stats.json"));
  EXPECT_EQ(stats["untouched"]["solid"], "low");
  EXPECT_EQ(stats["untouched"]["inside"], false);
  const double distance_mm = stats["untouched"]["distance_mm"].get<double>();
  EXPECT_NEAR(distance_mm, 80, 8) << "the fingertip is pressed into the cube, whose top is at y = 0";
  EXPECT_CONTAINS(
      below.out,
      fmt::format("nothing touched: the nearest skin was {:.1f} mm away from the surface of low\n", distance_mm));

  const Result far = run_of_cube_frames(folder, {{-0.02, -1.12, -0.02}, {0.02, -1.08, 0.02}});
  EXPECT_CONTAINS(far.out, "nothing touched: no skin was within 120 mm of the objects\n");
  EXPECT_TRUE(json::parse(read_text(folder / "stats.json"))["untouched"]["solid"].is_null());

  const Result within = run_of_cube_frames(folder, {{-0.03, -0.05, -0.03}, {0.03, 0.3, 0.03}});
  EXPECT_CONTAINS(within.out, " mm below the surface of low, deeper than its shell\n");
  EXPECT_EQ(json::parse(read_text(folder / "stats.json"))["untouched"]["inside"], true);
}

TEST(Untouched, AnExportOfTheSameFramesSaysTheSame) {
  const auto folder = scratch_folder("untouched-export");
  const Result run = run_of_cube_frames(folder, {{-0.02, -0.12, -0.02}, {0.02, -0.08, 0.02}});
  std::vector<std::string> line{"export",
                                "--scene",
                                (folder / "low.glb").string(),
                                "--source",
                                "recording:" + cube_frames().string(),
                                "--foci",
                                (folder / "foci.csv").string(),
                                "--json",
                                (folder / "export.json").string()};
  const Result export_ = succeeded(palpa_here(line));
  const std::size_t said = run.out.find("nothing touched: ");
  ASSERT_NE(said, std::string::npos);
  EXPECT_CONTAINS(export_.out, run.out.substr(said, run.out.find('\n', said) + 1 - said));
  EXPECT_EQ(json::parse(read_text(folder / "export.json"))["untouched"],
            json::parse(read_text(folder / "stats.json"))["untouched"]);
}

/// Numbers its frames; every third round has none.
class Counted final : public sensing::DepthSource {
 public:
  explicit Counted(std::uint64_t frames) : left_(frames) {}
  const std::vector<sensing::Camera>& cameras() const override { return cameras_; }
  bool next(sensing::FrameSet& out, double) override {
    out.frames.clear();
    if (++rounds_ % 3 == 0) return true;
    out.sequence = sequence_++;
    out.frames.assign(1, {.depth = {static_cast<std::uint16_t>(out.sequence)}});
    return left_-- > 0;
  }

 private:
  std::vector<sensing::Camera> cameras_;
  std::uint64_t left_, rounds_ = 0, sequence_ = 0;
};

TEST(Untouched, FramesAreKeptEvenlyOverTheWholeRun) {
  for (const std::uint64_t frames : {1, 7, 8, 100, 5000}) {
    Counted source(frames);
    setup::KeptFrames kept(source);
    sensing::FrameSet set;
    while (kept.next(set, 0)) {
    }
    const std::vector<sensing::FrameSet>& of = kept.frames();
    ASSERT_FALSE(of.empty());
    EXPECT_EQ(of.front().sequence, 0u);
    EXPECT_LT(of.size(), 8u);
    EXPECT_GE(of.size(), std::min<std::uint64_t>(frames, 4));
    const std::uint64_t apart = of.size() > 1 ? of[1].sequence : 1;
    for (std::size_t i = 0; i < of.size(); ++i) {
      EXPECT_EQ(of[i].sequence, i * apart) << frames;
      ASSERT_EQ(of[i].frames.size(), 1u) << frames;
      EXPECT_EQ(of[i].frames[0].depth.at(0), i * apart) << frames;
    }
    EXPECT_GE((of.size() + 1) * apart, frames) << "the last of them is near the end";
  }
}

}  // namespace
}  // namespace palpa::test
