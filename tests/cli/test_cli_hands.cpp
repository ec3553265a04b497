// Hands, most of them recorded: `palpa touch` finds exactly the fingers that a person sees in the depth picture. Camera
// frame = world.
#include <gtest/gtest.h>

#include <algorithm>
#include <glm/geometric.hpp>
#include <string>
#include <utility>
#include <vector>

#include "cli/support/boxes.hpp"
#include "cli/support/process.hpp"
#include "cli/support/touch_json.hpp"
#include "sensing/grey_png.hpp"
#include "sensing/rig.hpp"
#include "support/files.hpp"
#include "support/hand_tips.hpp"
#include "support/shared_data.hpp"
#include "touch/fingertips.hpp"

namespace palpa::test {
namespace {

namespace fs = std::filesystem;

struct Lens {
  std::uint32_t width, height;
  double f, cx, cy, unit_m;
};
constexpr Lens sr305{640, 480, 476.007, 313.683, 242.755, 0.000125};
// Nominal values of the first Kinect; the recording does not say its own.
constexpr Lens kinect{640, 480, 585, 320, 240, 0.001};

Vec3 point_at(const Lens& lens, const Pixel& p, double z) {
  return {(p.u - lens.cx) / lens.f * z, (p.v - lens.cy) / lens.f * z, z};
}
Pixel pixel_of(const Lens& lens, const Vec3& p) {
  return {lens.cx + lens.f * p.x / p.z, lens.cy + lens.f * p.y / p.z};
}

fs::path write_camera(const fs::path& folder, const Lens& lens) {
  sensing::Camera camera;
  camera.name = "recorded";
  camera.width = lens.width;
  camera.height = lens.height;
  camera.fx = camera.fy = lens.f;
  camera.cx = lens.cx;
  camera.cy = lens.cy;
  camera.depth_unit_m = lens.unit_m;
  camera.min_range_m = 0.1;
  write_text(folder / "camera.toml", sensing::to_toml({.file = {}, .cameras = {camera}}));
  return folder / "camera.toml";
}

/// A box whose face stands on the line between two pixels of the picture at depth z, edge-on to the camera; the box
/// lies on the line's left seen from `from` to `to` with v pointing down, and 12 cm before and behind z.
TiltedBox beside_line(const Lens& lens, const std::string& name, const Pixel& from, const Pixel& to, double z) {
  const Vec3 a = point_at(lens, from, z), b = point_at(lens, to, z);
  const Vec3 along = b - a;
  const Vec3 outwards(-along.y, along.x, 0);
  return {name, (a + b) / 2.0, outwards, along, glm::length(along) / 2, 0.12, 0.1};
}

class Hands : public testing::TestWithParam<std::string> {
 protected:
  /// What `palpa touch` reports for the image, with more options.
  static TouchReport touch(const fs::path& scene, const fs::path& image, const Lens& lens,
                           const std::vector<std::string>& more = {}, double delta = 1.5e-3) {
    return run_touch_here(with({"touch", "--scene", scene, "--depth", image, "--camera",
                                write_camera(scene.parent_path(), lens), "--backend", GetParam()},
                               more),
                          delta);
  }
};

// The picture: a right hand, spread, palm to the camera. Little, ring and middle finger point to the left and cross the
// column u = 240; the index finger points up and crosses the row v = 195, the thumb the row v = 208.
constexpr const char* sr305_hand = "depth-hand-sr305-ondris/20210326-230536_70.png";

TEST_P(Hands, Sr305AllFiveFingersReachIntoThreeBoxes) {
  PALPA_SHARED_OR_SKIP(image, sr305_hand);
  const fs::path scene = scratch_folder("hand-three-boxes") / "boxes.glb";
  write_boxes(scene, {beside_line(sr305, "left", {240, 290}, {240, 150}, 0.57),
                      beside_line(sr305, "top", {255, 195}, {300, 195}, 0.58),
                      beside_line(sr305, "thumb", {322, 208}, {370, 208}, 0.54)});
  const TouchReport report = touch(scene, image, sr305);
  std::vector<std::string> touched;
  for (const TouchFinger& finger : report.fingers)
    touched.push_back(finger.solid);
  std::sort(touched.begin(), touched.end());
  EXPECT_EQ(touched, (std::vector<std::string>{"left", "left", "left", "thumb", "top"}));
}

TEST_P(Hands, Sr305ThreeFingersReachIntoOneBoxAndTheWholeHandIntoTheOther) {
  PALPA_SHARED_OR_SKIP(image, sr305_hand);
  // On the left of the line three fingers end; on its right they hang together by the palm.
  const fs::path ends = scratch_folder("hand-inside-ends") / "box.glb",
                 palm = scratch_folder("hand-inside") / "box.glb";
  write_boxes(ends, {beside_line(sr305, "box", {240, 290}, {240, 150}, 0.57)});
  write_boxes(palm, {beside_line(sr305, "box", {240, 150}, {240, 290}, 0.57)});
  const TouchReport contacts = touch(ends, image, sr305), inside = touch(ends, image, sr305, {"--cluster", "inside"});
  EXPECT_EQ(inside.contacts, contacts.contacts);
  ASSERT_EQ(contacts.fingers.size(), 3u);
  ASSERT_EQ(inside.fingers.size(), 3u);
  // From the top of the picture: middle, ring, little.
  const double rows[]{204, 227, 256};
  for (std::size_t i = 0; i < 3; ++i) {
    const Pixel centre = pixel_of(sr305, contacts.fingers[i].centroid);
    EXPECT_NEAR(centre.u, 239.5, 1.5);
    EXPECT_NEAR(centre.v, rows[i], 6) << i;
    EXPECT_EQ(inside.fingers[i].indices, contacts.fingers[i].indices);
  }
  const TouchReport rings = touch(palm, image, sr305), hand = touch(palm, image, sr305, {"--cluster", "inside"});
  EXPECT_GE(rings.fingers.size(), 3u);
  ASSERT_EQ(hand.fingers.size(), 1u);
  EXPECT_EQ(hand.contacts, rings.contacts);
  EXPECT_EQ(hand.fingers[0].indices, hand.contacts);
}

/// One box per hand. Both hands lean towards the camera, fingertips first: a plane in front of the palm cuts all five
/// fingers.
std::vector<TiltedBox> kinect_boxes(const std::vector<HandTip>& tips) {
  // Pointing into the box, and how deep the shallowest tip of that hand lies in it. From 5 to 7 mm on the left and 1 to
  // 7 mm on the right every finger enters by one connected ring; deeper, planes almost along a finger graze it in
  // pieces.
  const std::pair<Vec3, double> planes[]{{{0.4931, 0.1606, -0.855}, 6e-3}, {{-0.1907, -0.1741, -0.9661}, 4e-3}};
  std::vector<TiltedBox> boxes;
  for (int hand = 1; hand <= 2; ++hand) {
    const auto& [inwards, depth] = planes[hand - 1];
    const Vec3 n = glm::normalize(inwards);
    Vec3 middle(0);
    double shallowest = 1e9;
    for (const HandTip& tip : tips) {
      if (tip.hand != hand) continue;
      const Vec3 p = point_at(kinect, tip.pixel, tip.z);
      middle += p / 5.0;
      shallowest = std::min(shallowest, glm::dot(n, p));
    }
    const Vec3 on_face = middle + n * (shallowest - depth - glm::dot(n, middle));
    boxes.push_back({hand == 1 ? "left" : "right", on_face, -n, Vec3(1, 0, 0), 0.14, 0.14, 0.15});
  }
  return boxes;
}

// Contacts are the ring of skin where a finger enters its box; its tip lies beyond. With a shell as thick as the box,
// all skin inside is a contact, and a cluster of it is all of a finger that is inside: that must hold exactly one
// labelled tip, and exactly one of the rings.
TEST_P(Hands, KinectTwoHandsAreTenFingersWithOneLabelledTipEach) {
  PALPA_SHARED_OR_SKIP(folder, "depth-hand-kinect1-candescent");
  const std::vector<HandTip> tips = read_tips(folder / "two_hands_labels.csv");
  ASSERT_EQ(tips.size(), 10u);
  const fs::path scene = scratch_folder("two-hands") / "boxes.glb";
  write_boxes(scene, kinect_boxes(tips));
  const TouchReport rings = touch(scene, folder / "two_hands.png", kinect);
  const TouchReport inside = touch(scene, folder / "two_hands.png", kinect, {"--delta", "0.5"}, 0.5);
  ASSERT_EQ(rings.fingers.size(), 10u);
  ASSERT_EQ(inside.fingers.size(), 10u);
  for (const TouchFinger& finger : inside.fingers) {
    const auto holds = [&](std::uint32_t index) {
      return std::binary_search(finger.indices.begin(), finger.indices.end(), index);
    };
    const auto labels = std::count_if(tips.begin(), tips.end(), [&](const HandTip& tip) {
      return holds(static_cast<std::uint32_t>(tip.pixel.v * kinect.width + tip.pixel.u));
    });
    EXPECT_EQ(labels, 1);
    const auto entered = std::count_if(rings.fingers.begin(), rings.fingers.end(), [&](const TouchFinger& ring) {
      return ring.solid == finger.solid && std::all_of(ring.indices.begin(), ring.indices.end(), holds);
    });
    EXPECT_EQ(entered, 1);
  }
}

TEST_P(Hands, APersonWithoutAHandTouchesNothing) {
  PALPA_SHARED_OR_SKIP(folder, "depth-hand-kinect1-candescent");
  const fs::path scene = scratch_folder("no-hand") / "boxes.glb";
  write_boxes(scene, kinect_boxes(read_tips(folder / "two_hands_labels.csv")));
  const TouchReport report = touch(scene, folder / "no_hand.png", kinect);
  EXPECT_GT(report.points, 100000u);
  EXPECT_TRUE(report.fingers.empty());
}

/// One fingertip that two cameras see from two sides: two patches.
TEST_P(Hands, TwoCamerasAreARigsOrAFileEach) {
  const fs::path folder = scratch_folder("two-cameras");
  const auto cameras = touch::test::ring_of_cameras(2, 20, 30);
  const auto images = touch::test::images_of(cameras, {{.press_m = 5e-3}}, 1);
  const auto write_rig = [](const fs::path& file, const std::vector<sensing::Camera>& of) {
    write_text(file, sensing::to_toml({.file = {}, .cameras = of}));
    return file.string();
  };
  std::vector<std::string> touch{"touch", "--scene", source_file("assets/cube.glb"), "--backend", GetParam()}, each;
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    const std::string name = folder / std::to_string(i), image = name + ".png";
    sensing::write_png16(image, cameras[i].width, cameras[i].height, images[i].depth);
    touch.insert(touch.end(), {"--depth", image});
    each.insert(each.end(), {"--camera", write_rig(name + ".toml", {cameras[i]})});
  }
  const std::vector<std::string> line = with(touch, {"--rig", write_rig(folder / "rig.toml", cameras)});
  const TouchReport both = run_touch_here(line);
  EXPECT_EQ(both.fingers.size(), 1u);
  EXPECT_EQ(run_touch_here(with(touch, each)).without_times, both.without_times);
  // Unless no finger is as wide.
  for (const char* width : {"10mm", "0"})
    EXPECT_EQ(run_touch_here(with(line, {"--finger-width", width})).fingers.size(), 2u) << width;
}

INSTANTIATE_TEST_SUITE_P(Backends, Hands, testing::Values("cpu", "gpu"), [](const auto& test) { return test.param; });

}  // namespace
}  // namespace palpa::test
