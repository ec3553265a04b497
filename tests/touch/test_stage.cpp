// The stage from skin to foci: depth frames and points, device and twin, with and without contacts.
#include "touch/stage.hpp"

#include <gtest/gtest.h>

#include "base/error.hpp"
#include "geometry/gltf.hpp"
#include "geometry/ply.hpp"
#include "gpu/commands.hpp"
#include "sensing/rig.hpp"
#include "sensing/synthetic.hpp"
#include "support/device.hpp"
#include "support/shared_data.hpp"
#include "touch/harness.hpp"

namespace palpa::touch::test {
namespace {

using palpa::test::source_file;
using palpa::test::test_device;

/// The paper's rig looks at the finger in the cube.
struct Scene {
  std::vector<sensing::Camera> cameras = sensing::load_rig(source_file("assets/rigs/paper.toml")).cameras;
  std::vector<geometry::Solid> solids = geometry::make_solids(geometry::load_gltf(source_file("assets/cube.glb")));
  geometry::Mesh finger;

  Scene() {
    geometry::Ply ply = geometry::read_ply(source_file("assets/finger.ply"));
    finger = {std::move(ply.positions), std::move(ply.triangles)};
  }
  std::vector<sensing::DepthFrame> frames(double depth_m) const {
    sensing::SyntheticRig rig(cameras, {}, sensing::Noise::d415, 1);
    Transform T(1.0);
    T[3] = Vec4(0, -depth_m, 0, 1);
    const sensing::Posed posed{&finger, T};
    sensing::FrameSet set;
    rig.render(std::span(&posed, 1), 0, set);
    return set.frames;
  }
};

/// Records, submits, waits and reads.
class Runner {
 public:
  explicit Runner(const Stage& stage) : stage_(stage) {}
  Touch run(StageFrame& frame, Detail detail, const Parameters& parameters = {}) {
    stage_.record(recorder_.begin(), frame, parameters, detail);
    timeline_.wait(timeline_.submit(recorder_.end()));
    Touch out;
    read(frame, out);
    return out;
  }

 private:
  const Stage& stage_;
  gpu::Recorder recorder_{test_device(), "stage test"};
  gpu::Timeline timeline_{test_device(), "stage test"};
};

TEST(Stage, DepthFramesOnTheDeviceAreThoseOfTheTwin) {
  const Scene scene;
  const Stage stage(test_device(), scene.solids, scene.cameras);
  StageFrame frame(test_device(), stage);
  HostStage host(scene.solids, scene.cameras);
  Runner runner(stage);
  for (const double depth : {3e-3, 1e-3, 5e-3}) {
    const auto images = scene.frames(depth);
    frame.set(images);
    Touch expected;
    host.touch(images, {}, expected);
    EXPECT_GT(expected.contacts.size(), 50u);
    expect_identical(expected, runner.run(frame, Detail::contacts));
  }
}

TEST(Stage, PointsOnTheDeviceAreThoseOfTheTwin) {
  const std::vector<geometry::Solid> solids{cube()};
  const Stage stage(test_device(), solids, {});
  StageFrame frame(test_device(), stage, {10'000, 10'000});
  HostStage host(solids, {});
  Runner runner(stage);
  for (const std::uint32_t count : {10'000u, 0u, 3000u}) {
    const auto points = indexed(fingertip(count, 3e-3));
    frame.set(points);
    Touch expected;
    host.touch(points, {}, expected);
    expect_identical(expected, runner.run(frame, Detail::contacts));
  }
}

TEST(Stage, ContactsStayOnTheDeviceWhereNobodyAsks) {
  const Scene scene;
  const Stage stage(test_device(), scene.solids, scene.cameras);
  StageFrame frame(test_device(), stage);
  frame.set(scene.frames(3e-3));
  Runner runner(stage);
  const Touch all = runner.run(frame, Detail::contacts);
  const Touch some = runner.run(frame, Detail::fingers);
  EXPECT_TRUE(some.contacts.empty());
  ASSERT_EQ(some.finger_count, all.finger_count);
  ASSERT_GT(all.finger_count, 0u);
  for (std::uint32_t f = 0; f < all.finger_count; ++f) {
    EXPECT_TRUE(some.fingers[f].contacts.empty());
    EXPECT_EQ(some.fingers[f].contact_count, all.fingers[f].contacts.size());
    EXPECT_EQ(all.fingers[f].contact_count, all.fingers[f].contacts.size());
    EXPECT_EQ(some.fingers[f].section.centroid, all.fingers[f].section.centroid);
    ASSERT_EQ(some.fingers[f].foci.size(), all.fingers[f].foci.size());
    for (std::size_t n = 0; n < all.fingers[f].foci.size(); ++n)
      EXPECT_EQ(some.fingers[f].foci[n].position, all.fingers[f].foci[n].position);
  }
  expect_identical(all, runner.run(frame, Detail::contacts));
}

TEST(Stage, RefusesInputThatDoesNotFit) {
  const Scene scene;
  const Stage seen(test_device(), scene.solids, scene.cameras), given(test_device(), scene.solids, {});
  StageFrame images(test_device(), seen), points(test_device(), given, {10, 10});
  const std::vector<sensing::SkinPoint> eleven(11);
  EXPECT_THROW(points.set(eleven), Error);
  EXPECT_NO_THROW(points.set(std::span(eleven).first(10)));
  EXPECT_THROW(images.set(std::span(eleven).first(1)), Error);
  EXPECT_THROW(images.set(std::vector<sensing::DepthFrame>(2)), Error);
  EXPECT_THROW(images.set(std::vector<sensing::DepthFrame>(3)), Error);
}

}  // namespace
}  // namespace palpa::touch::test
