// The facade that a program of its own uses: skin in, fingers, events and a schedule out, on both backends.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "array/board_mesh.hpp"
#include "base/error.hpp"
#include "geometry/gltf.hpp"
#include "geometry/ply.hpp"
#include "sensing/rig.hpp"
#include "sensing/synthetic.hpp"
#include "session/toucher.hpp"
#include "support/device.hpp"
#include "support/shared_data.hpp"

namespace palpa::session {
namespace {

std::vector<geometry::Solid> cube(double press_depth_m) {
  auto solids = geometry::make_solids(geometry::load_gltf(test::source_file("assets/cube.glb")));
  solids[0].haptics.press_depth_m = press_depth_m;
  return solids;
}

/// The finger model, its tip at `tip`.
std::vector<glm::vec3> finger_at(const Vec3& tip) {
  static const std::vector<Vec3> skin = geometry::read_ply(test::source_file("assets/finger.ply")).positions;
  std::vector<glm::vec3> points;
  for (const Vec3& p : skin)
    points.emplace_back(p + tip);
  return points;
}

class Touching : public testing::TestWithParam<bool> {
 protected:
  session::Toucher make(std::vector<geometry::Solid> solids, const ToucherOptions& options = {}) {
    return GetParam() ? session::Toucher(test::test_device(), std::move(solids), options)
                      : session::Toucher(std::move(solids), options);
  }
};

std::string kinds(std::span<const Event> events) {
  std::string text;
  for (const Event& event : events)
    text += std::string(text.empty() ? "" : " ") + std::string(name_of(event.kind));
  return text;
}

TEST_P(Touching, TellsWhatAFingerDoes) {
  session::Toucher toucher = make(cube(0.003));
  EXPECT_EQ(toucher.touch(finger_at({0, 0.002, 0}), 0.00).finger_count, 0U);
  EXPECT_EQ(kinds(toucher.events()), "");
  const touch::Touch& light = toucher.touch(finger_at({0, -0.0007, 0}), 0.01);
  ASSERT_EQ(light.finger_count, 1U);
  EXPECT_NEAR(light.fingers[0].depth_m, 0.0007, 1e-5);
  EXPECT_EQ(kinds(toucher.events()), "touch");
  EXPECT_EQ(toucher.solid_name(toucher.events()[0]), "cube");
  toucher.touch(finger_at({0, -0.0032, 0}), 0.02);
  EXPECT_EQ(kinds(toucher.events()), "move press");
  EXPECT_NEAR(toucher.events()[1].depth_m, 0.0032, 1e-5) << "the tip's, not that of the contacts";
  toucher.touch(finger_at({0.004, -0.0032, 0}), 0.03);
  EXPECT_EQ(kinds(toucher.events()), "move");
  EXPECT_NEAR(toucher.events()[0].centroid.x, 0.004, 3e-4);
  const auto schedule = toucher.schedule();
  ASSERT_EQ(schedule.voice_count, 1U);
  EXPECT_EQ(schedule.voices[0].foci.size(), 10U);
  EXPECT_EQ(schedule.time_s, 0.03);
  toucher.touch(std::vector<glm::vec3>(), 0.04);
  EXPECT_EQ(toucher.schedule().voice_count, 0U) << "silence at once";
  EXPECT_EQ(kinds(toucher.events()), "");
  toucher.touch(finger_at({0, 0.01, 0}), 0.085);
  EXPECT_EQ(kinds(toucher.events()), "release");
  toucher.touch(finger_at({0, -0.001, 0}), 0.09);
  EXPECT_EQ(kinds(toucher.end()), "release");
}

TEST_P(Touching, FollowsASolidThatMoves) {
  session::Toucher toucher = make(cube(0.003));
  EXPECT_EQ(toucher.touch(std::vector<glm::vec3>(), 0.00).finger_count, 0U);
  EXPECT_EQ(toucher.touch(finger_at({0, 0.05, 0}), 0.01).finger_count, 0U);
  Transform T(1.0);
  T[3] = Vec4(0, 0.0535, 0, 1);  // up to 3.5 mm above the fingertip
  toucher.set_pose(0, T);
  EXPECT_EQ(toucher.touch(finger_at({0, 0.05, 0}), 0.02).finger_count, 1U);
  EXPECT_EQ(kinds(toucher.events()), "touch press");
  EXPECT_NEAR(toucher.events()[0].depth_m, 0.0035, 1e-5);
}

TEST_P(Touching, TakesDepthFrames) {
  const sensing::Rig rig = sensing::load_rig(test::source_file("assets/rigs/paper.toml"));
  geometry::Ply ply = geometry::read_ply(test::source_file("assets/finger.ply"));
  const geometry::Mesh finger{std::move(ply.positions), std::move(ply.triangles)};
  sensing::SyntheticRig synthetic(rig.cameras, {}, sensing::Noise::none, 1);
  Transform T(1.0);
  T[3] = Vec4(0, -0.003, 0, 1);
  const sensing::Posed skin{&finger, T};
  sensing::FrameSet set;
  synthetic.render(std::span(&skin, 1), 0, set);
  ToucherOptions options;
  options.cameras = rig.cameras;
  session::Toucher toucher = make(cube(0.001), options);
  EXPECT_EQ(toucher.touch(set.frames, 0).finger_count, 1U);
  EXPECT_EQ(kinds(toucher.events()), "touch press");
  EXPECT_THROW(toucher.touch(finger_at({}), 0.1), Error);
  EXPECT_THROW(make(cube(0.001)).touch(set.frames, 0), Error);
}

TEST_P(Touching, RefusesWhatCannotSound) {
  auto solids = cube(0.001);
  solids[0].haptics.foci = 9;
  EXPECT_THROW(make(solids), Error);
  ToucherOptions options;
  options.voice.stride = 5;
  EXPECT_THROW(make(cube(0.001), options), Error);
  options = {};
  options.touch.foci = 0;
  EXPECT_THROW(make(cube(0.001), options).touch(finger_at({}), 0), Error);
}

TEST(ToucherGrows, WithTheCloudItIsGiven) {
  session::Toucher toucher(test::test_device(), cube(0.001));
  std::vector<glm::vec3> many = finger_at({0, -0.001, 0});
  const std::size_t contacts = toucher.touch(many, 0).contacts.size();
  many.resize(20'000, glm::vec3(1, 1, 1));
  EXPECT_EQ(toucher.touch(many, 0.01).contacts.size(), contacts);
  EXPECT_EQ(toucher.touch(finger_at({0, -0.001, 0}), 0.02).contacts.size(), contacts);
}

INSTANTIATE_TEST_SUITE_P(Backends, Touching, testing::Bool(),
                         [](const auto& backend) { return backend.param ? std::string("gpu") : std::string("cpu"); });

}  // namespace
}  // namespace palpa::session
