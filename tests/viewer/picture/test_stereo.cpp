// The participant's view: geometry of screen and eyes, and how two pictures are combined.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <random>

#include "support/device.hpp"
#include "viewer/picture/palette.hpp"
#include "viewer/render/drawing_test.hpp"
#include "viewer/render/participant.hpp"
#include "viewer/scenes.hpp"

namespace palpa::viewer {
namespace {

/// Tilted back and turned, so that none of its axes is one of the world's.
sensing::Screen leaning_screen() {
  sensing::Screen screen;
  screen.width_m = 0.345;
  screen.height_m = 0.194;
  const Vec3 x = glm::normalize(Vec3(0.9, 0.1, -0.3)), z = glm::normalize(glm::cross(x, Vec3(0.1, 1, -0.2)));
  screen.T_world_screen = {Vec4(x, 0), Vec4(glm::cross(z, x), 0), Vec4(z, 0), {0.02, 0.05, -0.35, 1}};
  screen.eye_m = transform_point(screen.T_world_screen, {0.08, 0.1, 0.9});
  return screen;
}

/// The place where the eye sees a point of the world, in pixels of a picture of the whole screen.
Vec2 seen(const sensing::Screen& screen, const Vec3& eye, const Vec3& world) {
  const Projected p = project(projection(eye_view(screen, eye, {}), 1920, 1080), world);
  EXPECT_TRUE(p.visible);
  return {p.x, p.y};
}

/// The pixel of a place on the screen.
Vec2 pixel_at(const sensing::Screen& screen, const Vec2& place) {
  return {(place.x / screen.width_m + 0.5) * 1920, (0.5 - place.y / screen.height_m) * 1080};
}

TEST(Stereo, WhatIsOnTheScreenIsAtTheSamePixelForBothEyes) {
  const sensing::Screen screen = leaning_screen();
  const Eyes eyes = eyes_before(screen, 0.063);
  EXPECT_NEAR(glm::distance(eyes.left, eyes.right), 0.063, 1e-12);
  EXPECT_LT(glm::distance((eyes.left + eyes.right) / 2.0, screen.eye_m), 1e-12);
  for (const Vec2& place : {Vec2(0, 0), Vec2(-0.17, 0.09), Vec2(0.1, -0.05)}) {
    const Vec3 world = transform_point(screen.T_world_screen, {place, 0});
    for (const Vec3& eye : {eyes.left, eyes.right})
      EXPECT_LT(glm::distance(seen(screen, eye, world), pixel_at(screen, place)), 0.02);
  }
}

TEST(Stereo, WhatIsInMidairIsOnTheLineFromTheEye) {
  const sensing::Screen screen = leaning_screen();
  const Eyes eyes = eyes_before(screen, 0.063);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> draw(-1, 1);
  for (int i = 0; i < 100; ++i) {
    // In front of the screen, and behind it.
    const Vec3 at(0.06 * draw(random), 0.04 * draw(random), 0.3 * draw(random));
    const Vec3 world = transform_point(screen.T_world_screen, at);
    for (const Vec3& eye : {eyes.left, eyes.right}) {
      const Vec3 e = transform_point(glm::inverse(screen.T_world_screen), eye);
      const Vec3 on = e + (at - e) * (e.z / (e.z - at.z));  // where the line meets the screen
      EXPECT_LT(glm::distance(seen(screen, eye, world), pixel_at(screen, Vec2(on))), 0.05);
    }
    // In front of the screen, the left eye sees it farther to the right; behind it, farther to the left.
    const double shift = seen(screen, eyes.left, world).x - seen(screen, eyes.right, world).x;
    EXPECT_EQ(shift > 0, at.z > 0) << at.z;
  }
}

TEST(Stereo, ThroughEverySlitEachEyeSeesItsOwnPixels) {
  sensing::Screen screen = leaning_screen();
  const Eyes eyes = eyes_before(screen, 0.063);
  const Barrier barrier = default_barrier(screen, eyes, Stereo::columns, 1920, 1080);
  EXPECT_GT(barrier.gap_m, 1e-3);
  EXPECT_LT(barrier.gap_m, 4e-3);
  const double column = screen.width_m / 1920;
  for (const double phase : {0.0, 0.3, 0.75}) {
    Barrier shifted = barrier;
    shifted.phase = phase;
    for (int slit = -400; slit <= 400; ++slit) {
      const double u = (slit + phase) * shifted.pitch_m;
      for (const bool left : {true, false}) {
        const Vec3 e = transform_point(glm::inverse(screen.T_world_screen), left ? eyes.left : eyes.right);
        const double on = e.x + (u - e.x) * e.z / (e.z - shifted.gap_m);
        // Everything that the middle half of the slit lets through.
        for (const double beside : {-0.24, 0.0, 0.24})
          EXPECT_EQ(is_left(screen, eyes, shifted, Stereo::columns, on + beside * column), left)
              << slit << " " << phase;
      }
    }
  }
  // Half a pitch further, every place belongs to the other eye.
  Barrier half = barrier;
  half.phase = 0.5;
  for (int i = 0; i < 1000; ++i) {
    const double place = (i / 1000.0 - 0.5) * 0.3 + 1e-7;
    EXPECT_NE(is_left(screen, eyes, barrier, Stereo::columns, place),
              is_left(screen, eyes, half, Stereo::columns, place));
  }
}

drawing::Pixels filled(const EyeSize& size, std::uint8_t red, std::uint8_t green, std::uint8_t blue) {
  drawing::Pixels pixels{size.width, size.height, {}};
  for (std::uint32_t i = 0; i < size.width * size.height; ++i)
    pixels.rgba.insert(pixels.rgba.end(), {red, green, blue, 255});
  return pixels;
}

TEST(Stereo, TwoPicturesBecomeOne) {
  const sensing::Screen screen = leaning_screen();
  const Eyes eyes = eyes_before(screen, 0.063);
  for (const Word<Stereo>& mode : stereo_words) {
    if (mode.value == Stereo::none) continue;
    const EyeSize size = eye_size(mode.value, 64, 48);
    const drawing::Pixels out = combine(filled(size, 200, 100, 0), filled(size, 0, 50, 150), screen, eyes,
                                        default_barrier(screen, eyes, mode.value, 64, 48), mode.value);
    ASSERT_EQ(out.width, 64u) << mode.word;
    ASSERT_EQ(out.height, 48u) << mode.word;
    const auto left = [&](std::uint32_t x, std::uint32_t y) { return out.at(x, y)[0] == 200; };
    for (std::uint32_t y = 0; y < 48; ++y) {
      for (std::uint32_t x = 0; x < 64; ++x) {
        const std::uint8_t* at = out.at(x, y);
        const bool right_of_another = x == 0 || left(x, 0) != left(x - 1, 0);
        const bool below_another = y == 0 || left(0, y) != left(0, y - 1);
        const bool as_it_should = mode.value == Stereo::side_by_side ? left(x, y) == (x < 32)
                                  : mode.value == Stereo::top_bottom ? left(x, y) == (y < 24)
                                  : mode.value == Stereo::columns    ? left(x, y) == left(x, 0) && right_of_another
                                  : mode.value == Stereo::rows
                                      ? left(x, y) == left(0, y) && below_another
                                      : at[0] == 119 && at[1] == 50 && at[2] == 150;  // red as bright as the left one
        ASSERT_TRUE(as_it_should) << mode.word << " " << x << " " << y;
      }
    }
  }
}

/// Rows alternate as the barrier does above the screen's middle, for an eye in the middle of the participant's two.
TEST(Stereo, EachRowIsThatOfTheEyeThatSeesItThroughTheBarrier) {
  const sensing::Screen screen = leaning_screen();
  const Eyes eyes = eyes_before(screen, 0.063);
  const Vec3 eye = transform_point(glm::inverse(screen.T_world_screen), screen.eye_m);
  constexpr std::uint32_t rows = 48;
  const Barrier usual = default_barrier(screen, eyes, Stereo::rows, 64, rows);
  for (const Barrier& barrier : {usual, Barrier{usual.pitch_m, 0, 0.5}, Barrier{2.6 * usual.pitch_m, 2e-3, 0.3}}) {
    const drawing::Pixels out =
        combine(filled({64, rows}, 200, 100, 0), filled({64, rows}, 0, 50, 150), screen, eyes, barrier, Stereo::rows);
    for (std::uint32_t y = 0; y < rows; ++y) {
      const double place = (0.5 - (y + 0.5) / rows) * screen.height_m;
      const double at = place + (eye.y - place) * barrier.gap_m / eye.z;  // where the line of sight meets the barrier
      const double turns = at / barrier.pitch_m - barrier.phase, part = turns - std::floor(turns);
      if (std::abs(part - 0.5) > 1e-6 && part > 1e-6 && part < 1 - 1e-6) {
        EXPECT_EQ(out.at(5, y)[0] == 200, part < 0.5) << y << " " << barrier.phase;
      }
    }
  }
}

TEST(Stereo, APixelThatHalvingLeavesOverIsItsNeighbour) {
  drawing::Pixels halves = filled({64, 48}, 1, 2, 3);
  halves.rgba[4 * 63] = 9;  // top right
  const drawing::Pixels out = grown_to(halves, 65, 49);
  ASSERT_EQ(out.width, 65u);
  ASSERT_EQ(out.height, 49u);
  ASSERT_EQ(out.rgba.size(), std::size_t{4} * 65 * 49);
  EXPECT_EQ(out.at(64, 0)[0], 9);
  EXPECT_EQ(out.at(64, 1)[0], 1);
  EXPECT_EQ(out.at(3, 48)[2], 3);
  EXPECT_EQ(grown_to(halves, 64, 48).rgba, halves.rgba);
}

using ViewerParticipant = test::DrawingTest;

TEST_F(ViewerParticipant, SeesSolidsAndTileAndNothingElse) {
  Participant participant{.screen = leaning_screen(), .stereo = Stereo::side_by_side};
  participant.screen.T_world_screen = Transform(1.0);
  participant.screen.T_world_screen[3] = Vec4(0, -0.2, -0.35, 1);
  participant.screen.eye_m = {0, 0.4, 0.6};
  Picture picture = test::cube_picture();
  geometry::Solid solid;
  solid.mesh = picture.solids[0].mesh;
  solid.bounds = geometry::bounds(solid.mesh);
  show_solids(picture, std::span(&solid, 1));
  ASSERT_TRUE(picture.tile);
  EXPECT_NEAR((*picture.tile)[0].y, 0.02, 5e-4) << "on the cube's top";
  picture.contacts.push_back({{0.05f, 0.05f, 0.02f}, 0u});
  ViewState all, none;
  for (const Word<Layer>& entry : layer_words) {
    all.layers[entry.value].visible = true;
    none.layers[entry.value].visible = false;
  }
  for (const Word<Layer>& entry : layer_words) {
    const bool object = entry.value == Layer::solids || entry.value == Layer::edges, tile = entry.value == Layer::tile;
    EXPECT_EQ(for_participant(all).layers[entry.value].visible, object || tile) << entry.word;
    EXPECT_EQ(for_participant(none).layers[entry.value].visible, tile) << entry.word;
  }
  const EyeSize size = eye_size(participant.stereo, 640, 180);
  DrawnPicture drawn(test::test_device());
  Offscreen offscreen(test::test_device(), size.width, size.height);
  ViewState state = for_participant({});
  drawn.update(picture, state);
  const Box objects = extent(picture, Extent::objects);
  const Pixels both = draw(participant, objects, 640, 180, offscreen, drawn);
  state.layers.hide({Layer::solids, Layer::edges});
  drawn.update_marks(picture, state);
  const Pixels tile = draw(participant, objects, 640, 180, offscreen, drawn);
  ASSERT_EQ(both.width, 640u);
  const Eyes eyes = eyes_before(participant.screen, participant.eyes_apart_m);
  const auto at = [&](const Pixels& pixels, const Vec3& world, bool left) {
    const Vec3& eye = left ? eyes.left : eyes.right;
    const Projected p = project(projection(eye_view(participant.screen, eye, objects), 320, 180), world);
    return pixels.at(static_cast<std::uint32_t>(p.x + (left ? 0 : 320)), static_cast<std::uint32_t>(p.y));
  };
  const auto is_tile = [&](const std::uint8_t* pixel) { return pixel[0] > 180 && pixel[2] < 110; };
  for (const bool left : {true, false}) {
    EXPECT_TRUE(is_tile(at(both, {0, 0.0203, 0}, left))) << left;
    EXPECT_TRUE(is_tile(at(tile, {0, 0.0203, 0}, left))) << left;
    EXPECT_LT(at(both, {0.005, -0.005, 0.02}, left)[0], 245) << "the cube";
    EXPECT_EQ(at(tile, {0.005, -0.005, 0.02}, left)[0], 255) << "hidden";
    EXPECT_EQ(at(both, {0.05, 0.05, 0.02}, left)[1], 255) << "no contact";
  }
}

}  // namespace
}  // namespace palpa::viewer
