#include "sensing/background.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "random_rig.hpp"
#include "sensing/synthetic.hpp"
#include "skin_run.hpp"
#include "support/shapes.hpp"
#include "support/thrown.hpp"

namespace palpa::sensing {
namespace {

/// A D415 at a third of its resolution, 0.6 m above the origin and looking down.
Camera small_camera() {
  Camera camera = test::d415(test::look_at({0.02, 0.6, 0.05}, {0, 0, 0}));
  camera.width = 280;
  camera.height = 160;
  camera.fx = camera.fy = 211;
  camera.cx = 139.5;
  camera.cy = 79.5;
  return camera;
}

SkinOfFrame found_in(const Camera& camera, const FrameSet& set) {
  return test_skin::run_twin({{camera}, set.frames}, {Vec3(-3), Vec3(3)});
}

TEST(Background, OfAStillSceneDropsThatSceneAndKeepsAHandBeforeIt) {
  Camera camera = small_camera();
  geometry::Mesh things = test::box({-0.4, -0.05, -0.4}, {0.4, -0.02, 0.4});  // a table
  geometry::append(things, test::box({0.05, -0.02, -0.1}, {0.12, 0.08, 0}));  // and a box on it
  SyntheticRig rig({camera}, things, Noise::d415, 3);
  BackgroundFrames frames(camera, 60);
  FrameSet set;
  for (std::uint64_t i = 0; i < 60; ++i) {
    rig.render({}, i, set);
    frames.add(set.frames[0].depth);
  }
  const LearnedBackground learned = frames.finish();
  EXPECT_GT(learned.pixels, 40'000U);
  EXPECT_LT(static_cast<double>(learned.unsteady), default_unsteady * static_cast<double>(learned.pixels));
  EXPECT_GT(learned.noise_m, 0.2e-3);
  EXPECT_LT(learned.noise_m, 4e-3);
  EXPECT_GE(learned.background.margin_m, 2e-3);
  EXPECT_LT(learned.background.margin_m, 12e-3);

  camera.background = std::make_shared<Background>(learned.background);
  std::uint64_t dropped = 0, still = 0;
  for (std::uint64_t i = 100; i < 110; ++i) {  // other noise
    rig.render({}, i, set);
    const SkinOfFrame found = found_in(camera, set);
    dropped += found.dropped[NoSkin::background];
    still += found.points.size();
  }
  EXPECT_GT(dropped, 400'000U);
  EXPECT_LT(static_cast<double>(still), 1e-3 * static_cast<double>(dropped));

  const geometry::Mesh hand = test::sphere(0.03, 16, 16);
  const Posed posed{&hand, Transform(Vec4(1, 0, 0, 0), Vec4(0, 1, 0, 0), Vec4(0, 0, 1, 0), Vec4(-0.05, 0.06, 0, 1))};
  rig.render(std::span(&posed, 1), 200, set);
  // The disc of the sphere: 211 pixels per metre at 1 m, its middle at 0.54 m.
  EXPECT_NEAR(static_cast<double>(found_in(camera, set).points.size()), 3.14 * 11.7 * 11.7, 90);
}

TEST(Background, IsTheSecondPercentileOfAPixelsDepths) {
  Camera camera = small_camera();
  camera.width = 3;
  camera.height = 1;
  camera.min_range_m = 0;
  BackgroundFrames frames(camera, 200);
  for (std::uint16_t i = 0; i < 200; ++i) {
    const auto shuffled = static_cast<std::uint16_t>(i * 77 % 200);
    // 200 depths from 6000 on; one that has a depth in every tenth frame only; one that never has any.
    const std::vector<std::uint16_t> depth{static_cast<std::uint16_t>(6000 + shuffled),
                                           static_cast<std::uint16_t>(i % 10 == 0 ? 7000 + i : 0), 0};
    frames.add(depth);
  }
  const LearnedBackground learned = frames.finish();
  EXPECT_EQ(learned.background.depth, (std::vector<std::uint16_t>{6003, 7000, 0}));
  EXPECT_EQ(learned.pixels, 2U);
  EXPECT_ERROR(frames.add(std::vector<std::uint16_t>(3)), Exit::usage, "more frames");
  EXPECT_ERROR(BackgroundFrames(camera, 5).add(std::vector<std::uint16_t>(4)), Exit::usage, "another size");
}

TEST(Background, SeesThatSomethingMoved) {
  Camera camera = small_camera();
  BackgroundFrames frames(camera, 40);
  for (std::uint32_t i = 0; i < 40; ++i) {
    std::vector<std::uint16_t> depth(pixel_count(camera));
    for (std::uint32_t pixel = 0; pixel < depth.size(); ++pixel) {
      const bool hand = pixel < depth.size() / 10 && i % 8 == 0;  // in a tenth of the image, now and then
      depth[pixel] = static_cast<std::uint16_t>((hand ? 4000 : 6000) + (pixel * 7 + i * 13) % 11);
    }
    frames.add(depth);
  }
  const LearnedBackground learned = frames.finish();
  EXPECT_NEAR(static_cast<double>(learned.unsteady) / static_cast<double>(learned.pixels), 0.1, 0.001);
  EXPECT_LT(learned.background.margin_m, 3e-3);  // those pixels say nothing about the noise
}

}  // namespace
}  // namespace palpa::sensing
