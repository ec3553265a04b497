// Hidden skin: patches on two sides of one fingertip are one finger, neighbouring fingertips are two.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>

#include "sensing/skin_twin.hpp"
#include "support/instrumented.hpp"
#include "touch/fingertips.hpp"
#include "touch/harness.hpp"

namespace palpa::touch::test {
namespace {

using Images = std::vector<sensing::DepthFrame>;
using Cameras = std::vector<sensing::Camera>;

Touch touch_of(const std::vector<geometry::Solid>& solids, const Cameras& cameras, const Images& images,
               const FingerOptions& parameters = {}) {
  Touch out;
  Stage(solids, cameras, {.parameters = parameters}).touch(images, out);
  return out;
}

FingerOptions unbridged() {
  return {.finger_width_m = 0};
}

TEST(Bridge, JoinsTheTwoSidesOfAFingertip) {
  const auto solids = object("cube");
  const Cameras cameras = ring_of_cameras(2, 20, 30);
  const Images images = images_of(cameras, {{.press_m = 5e-3}}, 1);
  const Touch apart = touch_of(solids, cameras, images, unbridged());
  ASSERT_EQ(apart.finger_count, 2u);
  const Touch joined = touch_of(solids, cameras, images);
  ASSERT_EQ(joined.finger_count, 1u);
  EXPECT_EQ(joined.cluster_count, 1u);
  const Finger& finger = joined.fingers[0];
  EXPECT_EQ(finger.contact_count, finger.contacts.size());
  EXPECT_TRUE(std::is_sorted(finger.contacts.begin(), finger.contacts.end()));
  std::vector<std::uint32_t> all = apart.fingers[0].contacts;
  all.insert(all.end(), apart.fingers[1].contacts.begin(), apart.fingers[1].contacts.end());
  std::sort(all.begin(), all.end());
  EXPECT_EQ(finger.contacts, all);
  // The centroid of both sides is the fingertip's axis; that of either side is not.
  EXPECT_LT(std::hypot(finger.section.centroid.x, finger.section.centroid.z), 1e-3);
  EXPECT_GT(std::hypot(apart.fingers[0].section.centroid.x, apart.fingers[0].section.centroid.z), 4e-3);
}

TEST(Bridge, JoinsTheTwoSidesThatCamerasOfUnlikeDepthUnitsSee) {
  const auto solids = object("cube");
  for (const auto& [first, second] : {std::pair{1e-3, 1e-4}, {1e-4, 1e-3}}) {
    Cameras cameras = ring_of_cameras(2, 20, 30);
    cameras[0].depth_unit_m = first;
    cameras[1].depth_unit_m = second;
    const Images images = images_of(cameras, {{.press_m = 5e-3}}, 1);
    EXPECT_EQ(touch_of(solids, cameras, images, unbridged()).finger_count, 2u) << first;
    EXPECT_EQ(touch_of(solids, cameras, images).finger_count, 1u) << first;
  }
}

TEST(Bridge, JoinsNothingWiderThanAFingerAndNothingWithoutImages) {
  const auto solids = object("cube");
  const Cameras cameras = ring_of_cameras(2, 20, 30);
  const Images images = images_of(cameras, {{.press_m = 5e-3}}, 1);
  for (const auto& [width, fingers] : {std::pair{0.0, 2u}, {5e-3, 2u}, {10e-3, 2u}, {18e-3, 1u}, {1.0, 1u}})
    EXPECT_EQ(touch_of(solids, cameras, images, {.finger_width_m = width}).finger_count, fingers) << width;
  Touch of_points;
  Stage(solids).touch(sensing::find_skin(cameras, images, touchable_box(prepare_solids(solids))), of_points);
  EXPECT_EQ(of_points.finger_count, 2u);
}

TEST(Bridge, TwoFingersStayTwo) {
  struct Case {
    const char* name;
    std::vector<geometry::Solid> solids;
    Cameras cameras;
    std::vector<Press> presses;
    std::uint64_t seed;
    std::uint32_t least = 0;  ///< fingers, since cameras need not see both
  };
  const auto cube = object("cube");
  std::vector<Case> cases;
  // Each of the two is two patches: joined the right way, not across.
  for (const double gap : {19e-3, 20e-3, 22e-3})
    cases.push_back({"seen from both sides",
                     cube,
                     ring_of_cameras(2, 0, 0),
                     {{.press_m = 5.2e-3, .z = -gap / 2}, {.press_m = 5.2e-3, .z = gap / 2}},
                     2,
                     2});
  cases.push_back({"only the outer sides are seen: the width tells",
                   cube,
                   ring_of_cameras(2, 20, 0),
                   {{.press_m = 5e-3, .x = -9.5e-3}, {.press_m = 5e-3, .x = 9.5e-3}},
                   3,
                   2});
  using Elevations = std::pair<double, double>;
  for (const auto& [pinch_deg, cross_deg] : palpa::test::the_first<Elevations>(1, {{-20, 0}, {0, -30}, {20, 20}})) {
    for (const int count : {1, 2, 3}) {
      cases.push_back({"thumb and index finger pinch a plate",
                       {box({-0.03, -0.009, -0.03}, {0.03, 0, 0.03}, "plate")},
                       ring_of_cameras(count, pinch_deg, 15),
                       {{.press_m = 4e-3}, {.press_m = 4e-3, .y = -9e-3, .from_below = true}},
                       5,
                       1});
      cases.push_back({"each leans over the other",
                       cube,
                       ring_of_cameras(count, cross_deg, 40),
                       {{.press_m = 4e-3, .tilt_deg = 50, .azimuth_deg = 30, .x = -8e-3, .z = -9e-3},
                        {.press_m = 4e-3, .tilt_deg = 50, .azimuth_deg = 150, .x = 8e-3, .z = 9e-3}},
                       6});
    }
  }
  for (const Case& c : cases) {
    SCOPED_TRACE(c.name);
    const Touch touch = touch_of(c.solids, c.cameras, images_of(c.cameras, c.presses, c.seed));
    EXPECT_GE(touch.finger_count, c.least);
    EXPECT_EQ(presses_in_fingers(touch, c.presses), std::vector<int>(touch.finger_count, 1))
        << c.cameras.size() << " cameras";
  }
}

TEST(Bridge, AFingerThroughAPlateIsOne) {
  // Its rings on both faces of the plate are apart, but cameras see the skin between them.
  for (const double thick_m : {8e-3, 14e-3}) {
    const std::vector<geometry::Solid> plate{box({-0.1, -thick_m, -0.1}, {0.1, 0, 0.1}, "plate")};
    for (const double tilt_deg : {0.0, 20.0, 50.0}) {
      const std::vector<Press> through{{.press_m = 28e-3, .tilt_deg = tilt_deg}};
      for (const int count : {1, 3}) {
        const Cameras cameras = paper_cameras(count);
        const Images images = images_of(cameras, through, 1);
        EXPECT_GE(touch_of(plate, cameras, images, unbridged()).finger_count, 2U);
        EXPECT_EQ(touch_of(plate, cameras, images).finger_count, 1U)
            << 1e3 * thick_m << " mm, leans by " << tilt_deg << " degrees, " << count << " cameras";
      }
    }
  }
}

TEST(Bridge, TheRingOfAFingerThatLiesHalfInsideIsOne) {
  // Its far end is farther from the near one than a finger is wide.
  const std::vector<geometry::Solid> plate{box({-0.1, -0.06, -0.1}, {0.1, 0, 0.1}, "plate")};
  for (const double azimuth_deg : {0.0, 90.0, 200.0}) {
    const std::vector<Press> sunk{{.press_m = 11e-3, .tilt_deg = 72, .azimuth_deg = azimuth_deg, .scale = 0.8}};
    for (const int count : {1, 2}) {
      const Cameras cameras = paper_cameras(count);
      const Images images = images_of(cameras, sunk, 1);
      EXPECT_EQ(touch_of(plate, cameras, images).finger_count, 1U)
          << "it points to " << azimuth_deg << " degrees, " << count << " cameras, without bridging "
          << touch_of(plate, cameras, images, unbridged()).finger_count;
    }
  }
}

TEST(Bridge, TheTwoSidesOfAFingerThatLeansAreOne) {
  // From side to side, its ring is longer than a finger is wide.
  const std::vector<geometry::Solid> plate{box({-0.1, -0.06, -0.1}, {0.1, 0, 0.1}, "plate")};
  for (const double tilt_deg : {50.0, 55.0, 60.0, 65.0}) {
    const std::vector<Press> leaning{{.press_m = 16e-3, .tilt_deg = tilt_deg}};
    for (const double azimuth_deg : {0.0, 20.0}) {
      const Cameras cameras = ring_of_cameras(2, 0, azimuth_deg);
      const Images images = images_of(cameras, leaning, 1);
      EXPECT_EQ(touch_of(plate, cameras, images, unbridged()).finger_count, 2U);
      EXPECT_EQ(touch_of(plate, cameras, images).finger_count, 1U) << tilt_deg << ' ' << azimuth_deg;
    }
  }
}

TEST(Bridge, NeighboursSeenFromAboveStayTwo) {
  // Fingertips that reach sideways into a wall, 2 to 6 mm apart, one camera above: the tops of two rings.
  const std::vector<geometry::Solid> wall{box({-0.1, -0.1, -0.1}, {-0.006, 0.1, 0.1}, "wall")};
  for (const double gap : palpa::test::the_first<double>(1, {20.5e-3, 22e-3, 24.5e-3})) {
    const std::vector<Press> presses{{.tilt_deg = 90, .z = -gap / 2}, {.tilt_deg = 90, .z = gap / 2}};
    for (const double elevation : {89.0, 60.0, 30.0}) {
      const Cameras camera = ring_of_cameras(1, elevation, 190);
      const Images images = images_of(camera, presses, 4);
      const std::uint32_t fingers = touch_of(wall, camera, images).finger_count;
      EXPECT_GE(fingers, 2u) << gap << ' ' << elevation;
      EXPECT_EQ(fingers, touch_of(wall, camera, images, unbridged()).finger_count) << gap << ' ' << elevation;
    }
  }
}

TEST(BridgeRates, FingertipsStayWholeAndNeighboursApart) {
  // Where the underside is hidden. docs/notes/finger-rates.md has the rates of many more.
  std::mt19937 random(11);
  int split_before = 0, split_after = 0, merged_by_bridging = 0;
  for (int t = 0; t < (palpa::test::instrumented() ? 16 : 40); ++t) {
    const Trial trial = random_trial(random, 2, t % 4 < 2 ? 0 : 20, trial_objects[t % 3], t % 2 == 0 ? 1 : 2);
    const auto solids = object(trial.object);
    const Touch before = touch_of(solids, trial.cameras, trial.images, unbridged());
    const Touch after = touch_of(solids, trial.cameras, trial.images);
    if (trial.presses.size() == 1) {
      split_before += before.finger_count > 1 ? 1 : 0;
      split_after += after.finger_count > 1 ? 1 : 0;
      continue;
    }
    const auto merged = [&](const Touch& touch) {
      const auto presses = presses_in_fingers(touch, trial.presses);
      return std::count(presses.begin(), presses.end(), 2);
    };
    merged_by_bridging += merged(after) > merged(before) ? 1 : 0;
  }
  EXPECT_GE(split_before, palpa::test::instrumented() ? 1 : 5);
  EXPECT_LE(split_after * 5, split_before);
  EXPECT_EQ(merged_by_bridging, 0);
}

TEST(Bridge, JoinsTheSidesOfManyFingersSeenThroughBentLenses) {
  // Small fingers in rows, seen through a distorting lens: more than 50 patches.
  Cameras cameras = ring_of_cameras(2, 15, 20);
  for (sensing::Camera& camera : cameras)
    camera.distortion = {0.08, -0.05, 1e-3, -2e-3, 0.01};
  const std::vector<geometry::Solid> plate{box({-0.1, -0.05, -0.1}, {0.1, 0, 0.1}, "plate")};
  std::vector<Press> presses;
  for (int i = 0; i < 25; ++i)
    presses.push_back({.press_m = 3e-3, .x = 24e-3 * (i % 5 - 2), .z = 24e-3 * (i / 5 - 2), .scale = 0.6});
  const Images images = images_of(cameras, presses, 7);
  const Touch before = touch_of(plate, cameras, images, unbridged());
  const Touch touch = touch_of(plate, cameras, images);
  EXPECT_GT(before.finger_count, 25u);
  EXPECT_LT(touch.finger_count, before.finger_count);
  EXPECT_EQ(presses_in_fingers(touch, presses), std::vector<int>(touch.finger_count, 1));
}

}  // namespace
}  // namespace palpa::touch::test
