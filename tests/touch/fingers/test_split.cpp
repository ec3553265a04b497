// Fingers side by side that are one cluster, and clusters that are not fingers, in the scenes of
// finger_scenes.hpp, which know the finger of each contact.
#include <gtest/gtest.h>

#include <random>

#include "sensing/grey_png.hpp"
#include "support/shared_data.hpp"
#include "touch/fingers/finger_scenes.hpp"
#include "touch/harness.hpp"

namespace palpa::touch::test {
namespace {

Touch touch_of(const FingerScene& scene, const FingerOptions& parameters) {
  Touch out;
  Stage({scene.solid}, scene.cameras, {.parameters = parameters}).touch(scene.images, out);
  return out;
}

struct Tally {
  int right = 0, split = 0, found = 0;
};

/// `trials` scenes of a kind.
Tally tally_of(SceneKind kind, int cameras, int trials) {
  std::mt19937 random(23);
  Tally tally;
  for (int t = 0; t < trials; ++t) {
    const FingerScene scene = random_scene(random, kind, cameras);
    const Touch touch = touch_of(scene, scene.parameters);
    const Score score = score_of(scene, touch);
    tally.right += score.right() ? 1 : 0;
    tally.split += score.split;
    tally.found += score.found;
  }
  return tally;
}

TEST(Split, FingersSideBySideAreFingers) {
  EXPECT_GE(tally_of(SceneKind::pair, 3, 4).right, 4);
  EXPECT_GE(tally_of(SceneKind::five, 3, 4).right, 3);
  EXPECT_GE(tally_of(SceneKind::pair_deep, 3, 4).right, 3);
  EXPECT_GE(tally_of(SceneKind::five_deep, 3, 4).right, 3);
}

TEST(Split, OneFingerStaysOneHoweverItLies) {
  for (const SceneKind kind : {SceneKind::single, SceneKind::flat, SceneKind::palm}) {
    for (const int cameras : {1, 3})
      EXPECT_EQ(tally_of(kind, cameras, 3).split, 0) << name_of(kind) << ", " << cameras;
  }
}

TEST(Split, FlyingPixelsAreNoFingers) {
  EXPECT_EQ(tally_of(SceneKind::rims, 3, 2).found, 0);
}

TEST(Split, NoFingerWidthAndNoPicturesDoNeither) {
  std::mt19937 random(23);
  for (const SceneKind kind : {SceneKind::pair_deep, SceneKind::rims}) {
    const FingerScene scene = random_scene(random, kind, 3);
    FingerOptions parameters = scene.parameters;
    const Touch with = touch_of(scene, parameters);
    parameters.finger_width_m = 0;
    const Touch without = touch_of(scene, parameters);
    std::vector<glm::vec3> points;
    for (const Contact& contact : without.contacts)
      points.push_back(contact.position);
    const Touch cloud = touch_on(Backend::cpu, points, {scene.solid}, scene.parameters);
    EXPECT_NE(with.finger_count, without.finger_count);
    ASSERT_EQ(cloud.finger_count, without.finger_count);
    for (std::uint32_t f = 0; f < cloud.finger_count; ++f)
      EXPECT_EQ(cloud.fingers[f].contacts, without.fingers[f].contacts);
    // Contacts are Eq. (1)'s, whatever becomes of fingers.
    ASSERT_EQ(with.contacts.size(), without.contacts.size());
    for (std::size_t i = 0; i < with.contacts.size(); ++i)
      EXPECT_EQ(with.contacts[i].point, without.contacts[i].point);
  }
}

TEST(Split, RingAndMiddleFingerOfARecordedHandAreTwo) {
  PALPA_SHARED_OR_SKIP(image, "depth-hand-sr305-ondris/20210326-230536_90.png");
  // A right hand, fingers up, side by side; a plate of 3 mm that they lie in. Between ring and middle finger (columns
  // 297 to 312 and 315 to 331) there is a gap of a few pixels without data, and a place where they touch.
  FingerScene scene;
  scene.cameras = {{.width = 640,
                    .height = 480,
                    .fx = 476.007,
                    .fy = 476.007,
                    .cx = 313.683,
                    .cy = 242.755,
                    .depth_unit_m = 0.000125,
                    .min_range_m = 0.1}};
  const sensing::Camera& camera = scene.cameras[0];
  const auto at = [&](double u, double v, double z) {
    return Vec3((u - camera.cx) / camera.fx * z, (v - camera.cy) / camera.fy * z, z);
  };
  scene.solid = box(at(268, 135, 0.563), at(370, 200, 0.566), "plate");
  scene.images.resize(1);
  sensing::read_png16(image, camera.width, camera.height, scene.images[0].depth);
  const auto holding_both = [&](const FingerOptions& parameters) {
    const Touch touch = touch_of(scene, parameters);
    int both = 0;
    for (std::uint32_t f = 0; f < touch.finger_count; ++f) {
      std::size_t ring = 0, middle = 0;
      for (const std::uint32_t i : touch.fingers[f].contacts) {
        const std::uint32_t u = touch.contacts[i].point % camera.width;
        ring += u >= 297 && u < 312 ? 1 : 0;
        middle += u >= 315 && u < 331 ? 1 : 0;
      }
      const std::size_t all = touch.fingers[f].contacts.size();
      both += 10 * ring >= all && 10 * middle >= all ? 1 : 0;
    }
    return both;
  };
  EXPECT_EQ(holding_both({.finger_width_m = 0}), 1);
  EXPECT_EQ(holding_both({}), 0);
}

TEST(Split, AllSkinInsideIsNotSplit) {
  std::mt19937 random(23);
  const FingerScene scene = random_scene(random, SceneKind::pair_deep, 3);
  EXPECT_EQ(touch_of(scene, {}).finger_count, 2u);
  EXPECT_EQ(touch_of(scene, {.cluster = Cluster::inside}).finger_count, 1u);
}

}  // namespace
}  // namespace palpa::touch::test
