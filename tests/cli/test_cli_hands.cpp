// Hands, most of them recorded: a touch finds exactly the fingers that a person sees in the depth picture. Computed in
// the tests' own process and by `palpa touch`. Camera frame = world.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <glm/geometric.hpp>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cli/support/boxes.hpp"
#include "cli/support/touch_here.hpp"
#include "cli/support/touch_json.hpp"
#include "sensing/grey_png.hpp"
#include "sensing/rig.hpp"
#include "session/session.hpp"
#include "setup/load.hpp"
#include "setup/tasks/touch.hpp"
#include "setup/touch_input.hpp"
#include "support/device.hpp"
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
  fs::path file = folder / "camera.toml";
  std::ofstream toml(file);
  toml.precision(17);
  toml << "[[camera]]\nname = \"recorded\"\nwidth = " << lens.width << "\nheight = " << lens.height
       << "\nfx = " << lens.f << "\nfy = " << lens.f << "\ncx = " << lens.cx << "\ncy = " << lens.cy
       << "\ndistortion = [0.0, 0.0, 0.0, 0.0, 0.0]\ndepth_unit_m = " << lens.unit_m
       << "\nmin_range_m = 0.1\nrate_hz = 30.0\nT_world_camera = [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, "
          "0.0, 1.0, "
          "0.0], [0.0, 0.0, 0.0, 1.0]]\n";
  return file;
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
  /// The report that `palpa touch` prints for the image, computed in the tests' own process and on their device.
  TouchReport touch(const fs::path& scene, const fs::path& image, const Lens& lens, double delta = 1.5e-3,
                    touch::Cluster cluster = touch::Cluster::contacts) {
    std::vector<geometry::Solid> solids = setup::load_solids(scene.string());
    setup::TouchInputOptions files;
    files.depths = {image.string()};
    files.cameras = {write_camera(scene.parent_path(), lens).string()};
    const setup::TouchInput input = setup::load_touch_input(files, solids);
    session::SessionSetting setting{.scene = scene.string(),
                                    .solids = std::move(solids),
                                    .cameras = input.cameras,
                                    .events = std::nullopt,
                                    .follow = false,
                                    .frame_by_frame = true};
    setting.touch.delta_m = delta;
    setting.touch.cluster = cluster;
    session::Session session = GetParam() == "gpu" ? session::Session(test_device(), std::move(setting))
                                                   : session::Session(std::move(setting));
    const touch::Touch& found = session.touch(input.frames, 0);
    const setup::TouchResult result{
        .one = {{}, std::move(session), found}, .points = input.point_count, .times = {{"in all", 0.0}}};
    return read_touch(to_json(result), delta);
  }
};

// The picture: a right hand, spread, palm to the camera. Little, ring and middle finger point to the left and cross the
// column u = 240; the index finger points up and crosses the row v = 195, the thumb the row v = 208.
constexpr const char* sr305_hand = "depth-hand-sr305-ondris/20210326-230536_70.png";

TEST_P(Hands, Sr305ThreeFingersReachIntoOneBox) {
  PALPA_SHARED_OR_SKIP(image, sr305_hand);
  const fs::path scene = scratch_folder("hand-one-box") / "box.glb";
  write_boxes(scene, {beside_line(sr305, "box", {240, 290}, {240, 150}, 0.57)});
  const TouchReport report = touch(scene, image, sr305);
  // The real program finds the same.
  const TouchReport command = run_touch({"--scene", scene.string(), "--depth", image.string(), "--camera",
                                         (scene.parent_path() / "camera.toml").string(), "--backend", GetParam()});
  EXPECT_EQ(command.without_times, report.without_times);
  ASSERT_EQ(report.fingers.size(), 3u);
  // From the top of the picture: middle, ring, little.
  const double rows[]{204, 227, 256};
  for (std::size_t i = 0; i < 3; ++i) {
    const Pixel centre = pixel_of(sr305, report.fingers[i].centroid);
    EXPECT_NEAR(centre.u, 239.5, 1.5);
    EXPECT_NEAR(centre.v, rows[i], 6) << i;
  }
}

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

TEST_P(Hands, Sr305SkinInsideIsThreeFingersOrTheWholeHand) {
  PALPA_SHARED_OR_SKIP(image, sr305_hand);
  // On the left of the line three fingers end; on its right they hang together by the palm.
  const fs::path ends = scratch_folder("hand-inside-ends") / "box.glb",
                 palm = scratch_folder("hand-inside") / "box.glb";
  write_boxes(ends, {beside_line(sr305, "box", {240, 290}, {240, 150}, 0.57)});
  write_boxes(palm, {beside_line(sr305, "box", {240, 150}, {240, 290}, 0.57)});
  const TouchReport contacts = touch(ends, image, sr305),
                    inside = touch(ends, image, sr305, 1.5e-3, touch::Cluster::inside);
  EXPECT_EQ(inside.contacts, contacts.contacts);
  ASSERT_EQ(inside.fingers.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_EQ(inside.fingers[i].indices, contacts.fingers[i].indices);
  const TouchReport rings = touch(palm, image, sr305), hand = touch(palm, image, sr305, 1.5e-3, touch::Cluster::inside);
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
  const TouchReport inside = touch(scene, folder / "two_hands.png", kinect, 0.5);
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

TEST_P(Hands, SeveralCamerasConcatenateTheirPixels) {
  PALPA_SHARED_OR_SKIP(image, sr305_hand);
  PALPA_SHARED_OR_SKIP(other, "depth-hand-sr305-ondris/20210326-230536_90.png");
  const fs::path folder = scratch_folder("two-cameras");
  const fs::path scene = folder / "box.glb";
  write_boxes(scene, {beside_line(sr305, "box", {240, 290}, {240, 150}, 0.57)});
  const std::string camera = write_camera(folder, sr305).string();
  const auto both = [&](const fs::path& first, const fs::path& second) {
    return run_touch_here({"--scene", scene.string(), "--backend", GetParam(), "--depth", first.string(), "--camera",
                           camera, "--depth", second.string(), "--camera", camera});
  };
  const TouchReport a = touch(scene, image, sr305), b = touch(scene, other, sr305), ab = both(image, other),
                    ba = both(other, image);
  EXPECT_EQ(ab.points, a.points + b.points);
  const auto joined = [](const TouchReport& first, const TouchReport& second) {
    std::vector<std::uint32_t> indices = first.contacts;
    for (const std::uint32_t index : second.contacts)
      indices.push_back(index + 640 * 480);
    return indices;
  };
  EXPECT_EQ(ab.contacts, joined(a, b));
  EXPECT_EQ(ba.contacts, joined(b, a));
}

/// One fingertip that two cameras see from two sides.
TEST_P(Hands, TwoPatchesOfAFingertipAreOneFingerUnlessNoWidthIsAllowed) {
  const fs::path folder = scratch_folder("finger-width");
  const auto cameras = touch::test::ring_of_cameras(2, 20, 30);
  const auto images = touch::test::images_of(cameras, {{.press_m = 5e-3}}, 1);
  std::vector<std::string> line{"--scene", source_file("assets/cube.glb").string(), "--backend", GetParam(),
                                "--rig",   (folder / "rig.toml").string()};
  std::ofstream(folder / "rig.toml") << sensing::to_toml({.file = {}, .cameras = cameras});
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    const fs::path image = folder / (std::to_string(i) + ".png");
    sensing::write_png16(image, cameras[i].width, cameras[i].height, images[i].depth);
    line.insert(line.end(), {"--depth", image.string()});
  }
  EXPECT_EQ(run_touch_here(line).fingers.size(), 1u);
  line.insert(line.end(), {"--finger-width", "10mm"});
  EXPECT_EQ(run_touch_here(line).fingers.size(), 2u);
  line.back() = "0";
  EXPECT_EQ(run_touch_here(line).fingers.size(), 2u);
}

/// The same fingertip, and a rig that ignores some of it: what is left touches as it did.
TEST_P(Hands, WhatACameraIgnoresIsNoSkin) {
  const fs::path folder = scratch_folder("ignored");
  auto cameras = touch::test::ring_of_cameras(2, 20, 30);
  const auto images = touch::test::images_of(cameras, {{.press_m = 5e-3}}, 1);
  std::vector<std::string> line{"--scene", source_file("assets/cube.glb").string(), "--backend", GetParam(),
                                "--rig",   (folder / "rig.toml").string()};
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    const fs::path image = folder / (std::to_string(i) + ".png");
    sensing::write_png16(image, cameras[i].width, cameras[i].height, images[i].depth);
    line.insert(line.end(), {"--depth", image.string()});
  }
  std::ofstream(folder / "rig.toml") << sensing::to_toml({.file = {}, .cameras = cameras});
  const TouchReport all = run_touch_here(line);

  // The left half of what touches in the one, every second row of the other.
  const auto first_end = static_cast<std::uint32_t>(sensing::pixel_count(cameras[0]));
  std::vector<std::uint32_t> columns;
  for (const std::uint32_t index : all.contacts) {
    if (index < first_end) columns.push_back(index % cameras[0].width);
  }
  ASSERT_FALSE(columns.empty());
  std::ranges::nth_element(columns, columns.begin() + static_cast<std::ptrdiff_t>(columns.size() / 2));
  cameras[0].roi = {0, 0, columns[columns.size() / 2], cameras[0].height};
  sensing::Mask mask{(folder / "rows.png").string(), {}};
  for (std::uint32_t v = 0; v < cameras[1].height; ++v)
    mask.pixels.insert(mask.pixels.end(), cameras[1].width, v % 2 == 0 ? 0 : 255);
  sensing::write_png8(mask.file, cameras[1].width, cameras[1].height, mask.pixels);
  cameras[1].mask = std::make_shared<sensing::Mask>(mask);
  std::ofstream(folder / "rig.toml") << sensing::to_toml({.file = {}, .cameras = cameras});
  const auto ignored = [&](std::uint32_t index) {
    const std::size_t c = index < first_end ? 0 : 1;
    const std::uint32_t pixel = index - (c == 0 ? 0 : first_end);
    return sensing::is_ignored(cameras[c], pixel % cameras[c].width, pixel / cameras[c].width);
  };
  std::uint64_t points = 0;
  for (std::uint32_t index = 0; index < first_end + sensing::pixel_count(cameras[1]); ++index) {
    const std::uint16_t depth = index < first_end ? images[0].depth[index] : images[1].depth[index - first_end];
    points += !ignored(index) && depth >= sensing::first_valid_depth(cameras[0]);
  }
  std::vector<std::uint32_t> kept = all.contacts;
  std::erase_if(kept, ignored);
  ASSERT_LT(kept.size(), all.contacts.size());
  ASSERT_GT(kept.size(), 20u);
  const TouchReport some = run_touch_here(line);
  EXPECT_EQ(some.points, points);
  EXPECT_EQ(some.contacts, kept);
}

INSTANTIATE_TEST_SUITE_P(Backends, Hands, testing::Values("cpu", "gpu"), [](const auto& test) { return test.param; });

}  // namespace
}  // namespace palpa::test
