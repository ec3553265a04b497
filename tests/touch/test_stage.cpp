// The stage from skin to foci: depth frames and points, device and twin, with and without contacts.
#include "touch/stage.hpp"

#include <gtest/gtest.h>

#include "base/error.hpp"
#include "geometry/gltf/gltf.hpp"
#include "sensing/rig.hpp"
#include "sensing/synthetic.hpp"
#include "support/barriers.hpp"
#include "support/hand_skin.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"
#include "touch/contacts/pixel_stride.hpp"
#include "touch/harness.hpp"

namespace palpa::touch::test {
namespace {

using palpa::test::source_file;

/// The paper's rig looks at the finger in the cube.
struct Scene {
  std::vector<sensing::Camera> cameras = sensing::load_rig(source_file("assets/rigs/paper.toml")).cameras;
  std::vector<geometry::Solid> solids = geometry::make_solids(geometry::load_gltf(source_file("assets/cube.glb")));

  std::vector<sensing::DepthFrame> frames(double depth_m) const {
    sensing::SyntheticRig rig(cameras, {}, sensing::Noise::d415, 1);
    Transform T(1.0);
    T[3] = Vec4(0, -depth_m, 0, 1);
    const sensing::Posed posed{&palpa::test::finger_skin().mesh, T};
    sensing::FrameSet set;
    rig.render(std::span(&posed, 1), 0, set);
    return set.frames;
  }
};

TEST(Stage, DepthFramesOnTheDeviceAreThoseOfTheTwin) {
  const Scene scene;
  DeviceStage stage(scene.solids, scene.cameras);
  Stage host(scene.solids, scene.cameras);
  for (const double depth : {3e-3, 1e-3, 5e-3}) {
    const auto images = scene.frames(depth);
    Touch expected, found;
    host.touch(images, expected);
    EXPECT_GT(expected.contacts.size(), 50u);
    stage.touch(images, found);
    expect_identical(expected, found);
  }
}

TEST(MissingBarriers, AreSeenBetweenTheSkinAndItsTouch) {
  const Scene scene;
  const auto images = scene.frames(3e-3);
  DeviceStage stage(scene.solids, scene.cameras);
  Touch touch;
  const palpa::test::NoBarrierAfter none("skin_scatter");
  EXPECT_CONTAINS(palpa::test::error_of([&] { stage.touch(images, touch); }, Exit::failed), "which skin_scatter wrote");
}

TEST(Stage, AStrideLeavesFingersWhereTheyAre) {
  const Scene scene;
  DeviceStage stage(scene.solids, scene.cameras);
  Stage host(scene.solids, scene.cameras);
  EXPECT_EQ(stage.most_pixel_stride(), host.most_pixel_stride());
  ASSERT_GE(host.most_pixel_stride(), 2u);
  const auto images = scene.frames(3e-3);
  Touch whole, again;
  host.touch(images, whole);
  ASSERT_EQ(whole.finger_count, 1u);
  for (std::uint32_t stride = 2; stride <= host.most_pixel_stride(); ++stride) {
    stage.set_pixel_stride(stride);
    host.set_pixel_stride(stride);
    Touch expected, found;
    host.touch(images, expected);
    stage.touch(images, found);
    expect_identical(expected, found);
    const auto fewer = static_cast<double>(whole.contacts.size()) / static_cast<double>(expected.contacts.size());
    EXPECT_NEAR(fewer, stride * stride, 0.35 * stride * stride);
    ASSERT_EQ(expected.finger_count, 1u) << stride;
    EXPECT_LT(glm::length(expected.fingers[0].section.centroid - whole.fingers[0].section.centroid), 1e-3f) << stride;
    EXPECT_EQ(expected.fingers[0].foci.size(), whole.fingers[0].foci.size());
  }
  stage.set_pixel_stride(1);
  stage.touch(images, again);
  expect_identical(whole, again);
}

TEST(Stage, AtAStrideFewerContactsMakeAFinger) {
  FingerOptions parameters;
  parameters.min_points = 5;
  EXPECT_EQ(at_stride(parameters, 1).min_points, 5u);
  EXPECT_EQ(at_stride(parameters, 2).min_points, 3u) << "a cross-section needs three";
  parameters.min_points = 100;
  EXPECT_EQ(at_stride(parameters, 2).min_points, 25u);
  EXPECT_EQ(at_stride(parameters, 3).min_points, 12u);
  parameters.min_points = 1;
  EXPECT_EQ(at_stride(parameters, 4).min_points, 1u);
  EXPECT_EQ(at_stride(parameters, 4).finger_gap_m, parameters.finger_gap_m);
}

TEST(Stage, AStrideNeverTakesPixelsOfOneFingerFartherApartThanTheGap) {
  const Scene scene;
  const auto most = [&](double gap_m) {
    return Stage(scene.solids, scene.cameras, {.parameters = {.finger_gap_m = gap_m}}).most_pixel_stride();
  };
  EXPECT_EQ(most(0.5e-3), 1u);
  EXPECT_GE(most(5e-3), most(2e-3));
  EXPECT_EQ(most(50e-3), 4u);
}

TEST(Stage, RefusesInputThatDoesNotFit) {
  const Scene scene;
  Stage seen(test_passes(), scene.solids, scene.cameras), given(test_passes(), scene.solids, {}, {.most_points = 10});
  const std::vector<sensing::SkinPoint> eleven(11);
  Touch touch;
  EXPECT_ERROR(given.touch(eleven, touch), Exit::usage, "11 skin points");
  EXPECT_NO_THROW(given.touch(std::span(eleven).first(10), touch));
  Stage on_host(scene.solids, scene.cameras);
  for (Stage* stage : {&seen, &on_host}) {
    EXPECT_ERROR(stage->touch(eleven, touch), Exit::usage, "a stage with cameras");
    EXPECT_ERROR(stage->touch(std::vector<sensing::DepthFrame>(2), touch), Exit::usage, "2 depth frames for 3 cameras");
    EXPECT_ERROR(stage->touch(std::vector<sensing::DepthFrame>(3), touch), Exit::usage, "depth frame 0 has 0 pixels");
  }
  EXPECT_ERROR(given.touch(std::vector<sensing::DepthFrame>(1), touch), Exit::usage, "a stage without cameras");
}

TEST(Stage, SaysWhenCamerasSeeMoreThanThereIsRoomFor) {
  const Scene scene;
  DeviceStage stage(scene.solids, scene.cameras, {.most_points = 100});
  Touch touch;
  const Error error = palpa::test::thrown_by([&] { stage.touch(scene.frames(3e-3), touch); });
  EXPECT_CONTAINS(error.what(), "skin points in one frame: there is room for 100");
}

}  // namespace
}  // namespace palpa::touch::test
