// The look of layers, separated parts, sections and images.
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <vector>

#include "drawn.hpp"
#include "support/cameras.hpp"
#include "viewer/picture/depth_image.hpp"

namespace palpa::viewer {
namespace {

using ViewerLayers = test::DrawingTest;
using test::distance;
using test::pixel_at;

constexpr std::uint32_t width = 240, height = 180;

Pixels draw(const Picture& picture, const ViewState& state) {
  return test::shoot(picture, {.state = state, .width = width, .height = height});
}

/// The mean difference of the two, in steps of 255.
double change(const Pixels& a, const Pixels& b) {
  return 255 * drawing::mean_difference(a, b);
}

/// Some content for every layer with its own items.
Picture everything() {
  Picture picture = test::cube_picture();
  picture.skin = SurfaceMark{"finger", test::box({0.012, -0.01, -0.01}, {0.035, 0.01, 0.01})};
  for (int i = 0; i < 30; ++i)
    picture.skin_points.emplace_back(-0.03 + 0.002 * i, 0.025, 0.02);
  for (int i = 0; i < 5; ++i)
    picture.contacts.push_back({{-0.015f, 0.002f * static_cast<float>(i), 0.021f}, 0u});
  picture.tile = {
      glm::vec3(-0.005, 0.021, 0.005), {0.005, 0.021, 0.005}, {0.005, 0.021, -0.005}, {-0.005, 0.021, -0.005}};
  FingerMarks finger;
  finger.foci = {{{-0.01f, -0.01f, 0.02f}, 1}, {{0.01f, -0.01f, 0.02f}, 2}};
  finger.section =
      SectionMark{{0, 0, 0.02f}, {glm::vec3(1, 0, 0), glm::vec3(0, 1, 0), glm::vec3(0, 0, 1)}, {0.01f, 0.006f}};
  picture.fingers.push_back(finger);
  picture.transducers.push_back({{-0.03f, -0.02f, 0}, {0, 0, 1}, 0, 0});
  picture.boards.push_back({glm::vec3(-0.04, -0.03, 0), {-0.02, -0.03, 0}, {-0.02, -0.01, 0}, {-0.04, -0.01, 0}});
  sensing::Camera camera = test::pinhole("one", 8, 8, 16);
  camera.T_world_camera[3] = Vec4(0.03, 0, 0, 1);
  show_cameras(picture, std::span(&camera, 1));
  const sensing::DepthFrame frame{std::vector<std::uint16_t>(64, 300), 0};
  show_depth(picture, std::span(&camera, 1), std::span(&frame, 1));
  return picture;
}

TEST_F(ViewerLayers, EachIsShownHiddenAndFaded) {
  const Picture picture = everything();
  ViewState all;
  for (const Word<Layer>& entry : layer_words)
    all.layers[entry.value].visible = true;
  DrawnPicture drawn(test::test_device());
  drawn.update(picture, all);
  Offscreen offscreen(test::test_device(), width, height);
  const auto draw = [&](const ViewState& state) {
    drawn.update_marks(picture, state);
    offscreen.draw(drawn, test::front_viewpoint());
    return offscreen.pixels();
  };
  for (const Word<Layer>& entry : layer_words) {
    if (entry.value == Layer::slice || entry.value == Layer::heat) continue;  // of a field: they have their own tests
    ViewState shown = all;
    shown.layers[Layer::legend].visible = entry.value == Layer::legend;  // its backing covers others
    const Pixels whole = draw(shown);
    ViewState without = shown, faint = shown, none = shown;
    without.layers[entry.value].visible = false;
    faint.layers[entry.value].opacity = 0.5f;
    none.layers[entry.value].opacity = 0;
    const Pixels hidden = draw(without);
    EXPECT_GT(change(whole, hidden), 0.01) << entry.word;
    EXPECT_EQ(draw(none).rgba, hidden.rgba) << entry.word;
    const Pixels half = draw(faint);
    EXPECT_GT(change(whole, half), 0.004) << entry.word;
    EXPECT_GT(change(half, hidden), 0.004) << entry.word;
  }
}

TEST_F(ViewerLayers, PartsAreTakenApartFromTheirSolidsMiddle) {
  Picture picture;
  picture.solids.push_back({"two", test::box({-0.02, -0.01, -0.01}, {0, 0.01, 0.01}), 0u});
  picture.solids.push_back({"two", test::box({0, -0.01, -0.01}, {0.02, 0.01, 0.01}), 1u});
  picture.solids.push_back({"whole", test::box({-0.005, 0.02, -0.005}, {0.005, 0.03, 0.005})});
  picture.solids.push_back({"other", test::box({0.01, -0.03, -0.005}, {0.03, -0.02, 0.005}), 0u});
  picture.solids.push_back({"other", test::box({0.03, -0.03, -0.005}, {0.05, -0.02, 0.005}), 1u});
  picture.solids.push_back({"the next", test::box({0.01, -0.04, -0.005}, {0.03, -0.03, 0.005}), 0u});
  const std::vector<Vec3> ways = apart(picture.solids);
  EXPECT_EQ(ways[0], Vec3(-0.02, 0, 0));
  EXPECT_EQ(ways[1], Vec3(0.02, 0, 0));
  EXPECT_EQ(ways[2], Vec3(0));
  EXPECT_LT(glm::distance(ways[3], Vec3(-0.02, 0, 0)), 1e-12);
  EXPECT_LT(glm::distance(ways[4], Vec3(0.02, 0, 0)), 1e-12);
  EXPECT_EQ(ways[5], Vec3(0)) << "the first part of another solid";
  picture.solids.resize(3);
  ViewState state = test::bare_view();
  const Colour paper = test::paper();
  const Pixels together = draw(picture, state);
  EXPECT_GT(distance(pixel_at(together, {0.006, 0.004, 0.01}), paper), 20);
  EXPECT_LE(distance(pixel_at(together, {0.03, 0.004, 0.01}), paper), 1);
  state.explode = 1;
  const Pixels exploded = draw(picture, state);
  EXPECT_LE(distance(pixel_at(exploded, {0.006, 0.004, 0.01}), paper), 1);
  EXPECT_GT(distance(pixel_at(exploded, {0.03, 0.004, 0.01}), paper), 20);
  EXPECT_GT(distance(pixel_at(exploded, {0, 0.024, 0.005}), paper), 20);
  EXPECT_EQ(extent(picture, Extent::objects, state).high.x, 0.04);
  EXPECT_EQ(extent(picture, Extent::objects).high.x, 0.02);
}

TEST_F(ViewerLayers, AnImageHasItsPixelsWhereItsCornersAre) {
  Picture picture;
  ImageMark image;
  image.corners = {glm::vec3(-0.02, 0.02, 0), {0.02, 0.02, 0}, {0.02, -0.02, 0}, {-0.02, -0.02, 0}};
  image.width = 2;
  image.height = 2;
  const Colour red = rgb(0xff0000), green = rgb(0x00ff00), blue = rgb(0x0000ff), grey = rgb(0x808080, 0.5f);
  image.pixels = {to_pixel(red), to_pixel(green), to_pixel(blue), to_pixel(grey)};
  picture.images = {{image.layer, image.corners, 1, 1, {to_pixel(rgb(0))}}, image};
  picture.images[0].corners.fill(glm::vec3(0.5, 0, 0));  // at another place: the pixels of the other image come after
                                                         // its own
  ViewState state = test::bare_view();
  state.layers[Layer::depth].visible = true;
  const Pixels pixels = draw(picture, state);
  EXPECT_LE(distance(pixel_at(pixels, {-0.014, 0.014, 0}), red), 2);
  EXPECT_LE(distance(pixel_at(pixels, {0.014, 0.014, 0}), green), 2);
  EXPECT_LE(distance(pixel_at(pixels, {-0.014, -0.014, 0}), blue), 2);
  EXPECT_LE(distance(pixel_at(pixels, {0.014, -0.014, 0}), mix(test::paper(), grey, 0.5f)), 3);
  EXPECT_LE(distance(pixel_at(pixels, {0, 0.014, 0}), mix(red, green, 0.5f)), 8) << "halfway between two pixels";
}

TEST_F(ViewerLayers, DepthIsLightWhereItIsNear) {
  sensing::Camera camera;
  camera.width = 500;  // more than an image has: every third pixel
  camera.height = 40;
  camera.min_range_m = 0.2;
  sensing::DepthFrame frame;
  for (std::uint32_t y = 0; y < camera.height; ++y) {
    for (std::uint32_t x = 0; x < camera.width; ++x)
      frame.depth.push_back(static_cast<std::uint16_t>(x < 50 ? 0 : x < 100 ? 150 : 300 + x));
  }
  ImageMark image;
  paint_depth(camera, frame, image);
  EXPECT_EQ(image.width, 167u);
  EXPECT_EQ(image.height, 14u);
  ASSERT_EQ(image.pixels.size(), 167u * 14u);
  const auto alpha = [&](std::size_t i) { return image.pixels[i] >> 24; };
  const auto green = [&](std::size_t i) { return image.pixels[i] >> 8 & 255; };
  EXPECT_LT(alpha(10), 128u) << "no data";
  EXPECT_LT(alpha(25), 128u) << "nearer than the camera can see";
  EXPECT_EQ(alpha(40), 255u);
  EXPECT_GT(green(40), green(100) + 40);
  EXPECT_GT(green(100), green(160) + 20);
  frame.depth.pop_back();
  paint_depth(camera, frame, image);
  EXPECT_TRUE(image.pixels.empty()) << "of no such camera";
}

// Every step-th pixel, where the longer side would have more than 240.
TEST(DepthImages, AreAsFineAsTheirLongerSideAllows) {
  for (const auto& [width, height, step] : {std::array{240u, 135u, 1u},
                                            {241u, 135u, 2u},
                                            {480u, 270u, 2u},
                                            {270u, 480u, 2u},
                                            {481u, 270u, 3u},
                                            {640u, 480u, 3u},
                                            {720u, 480u, 3u}}) {
    sensing::Camera camera;
    camera.width = width;
    camera.height = height;
    ImageMark image;
    paint_depth(camera, {std::vector<std::uint16_t>(std::size_t{width} * height, 500), 0}, image);
    EXPECT_EQ(image.width, (width + step - 1) / step) << width;
    EXPECT_EQ(image.height, (height + step - 1) / step) << width;
  }
}

}  // namespace
}  // namespace palpa::viewer
