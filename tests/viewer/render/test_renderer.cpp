// What is drawn, and what it costs.
#include <gtest/gtest.h>

#include <glm/geometric.hpp>
#include <limits>
#include <utility>
#include <vector>

#include "drawn.hpp"
#include "support/thrown.hpp"

namespace palpa::viewer {
namespace {

using Renderer = test::DrawingTest;
using test::distance;
using test::paper;
using test::pixel_at;
using test::shoot;
using test::Shot;

constexpr std::uint32_t width = 320, height = 240;
const Shot large{.width = 640, .height = 480};

TEST_F(Renderer, AnEmptySceneIsBackground) {
  for (const bool dark : {false, true}) {
    Shot shot;
    shot.state.dark = dark;
    EXPECT_EQ(test::count_not(shoot({}, shot), paper(dark)), 0u) << dark;
  }
}

TEST_F(Renderer, PieceByPieceThePictureIsTheSame) {
  DrawnPicture drawn(test::test_device());
  drawn.update(test::cube_picture(), ViewState{});
  const std::vector<View> views{whole(test::front_viewpoint(), width, height),
                                close_up(test::front_viewpoint(), Box{Vec3(-0.01), Vec3(0.01)}, width, height, 1)};
  for (const Fineness fineness : {Fineness::quick, Fineness::fine}) {
    Offscreen offscreen(test::test_device(), width, height, 1, fineness);
    offscreen.draw(drawn, views);
    const Pixels at_once = offscreen.pixels();
    int pieces = 0;
    offscreen.draw(drawn, views, nullptr, [&] { ++pieces; });
    EXPECT_GT(pieces, 8);
    EXPECT_EQ(offscreen.pixels().rgba, at_once.rgba);
  }
}

TEST_F(Renderer, ACubeIsWhereItShouldBeTranslucentWithFaintHiddenEdges) {
  const Pixels pixels = shoot(test::cube_picture());
  const auto at = [&](double x, double y, double z) { return pixel_at(pixels, {x, y, z}); };
  // The back face, then the front face, each the solid's colour under the light of mesh.frag, over the background.
  const Theme& theme = theme_of(false);
  const float light = 0.62f + 0.26f + 0.16f * 0.5f;
  const Colour lit{theme.solid.r * light, theme.solid.g * light, theme.solid.b * light, 1};
  const Colour expected = mix(mix(theme.background, lit, theme.solid.a), lit, theme.solid.a);
  const std::uint8_t* face = at(0.003, 0.004, 0.02);
  EXPECT_LE(distance(face, expected), 3);
  // Its front face ends at 0.02 m, 0.18 m in front of the eye. Just outside, there is background; on the rim, a dark
  // edge.
  EXPECT_LE(distance(at(0.0225, 0.004, 0.02), theme.background), 1);
  EXPECT_LE(distance(at(0.018, 0.004, 0.02), expected), 40);
  EXPECT_LT(at(0.02, 0.005, 0.02)[0], 140);
  EXPECT_LT(at(-0.02, -0.005, 0.02)[0], 140);
  // The back face's edges show through the front face.
  const int hidden = at(0.0, 0.02, -0.02)[0];
  EXPECT_LT(hidden, face[0] - 15);
  EXPECT_LT(at(0.0, 0.02, 0.02)[0], hidden - 30);
}

TEST_F(Renderer, ContactsHaveTheirFingersColour) {
  Picture picture;
  for (std::uint32_t f = 0; f < 4; ++f)
    picture.contacts.push_back({{-0.015f + 0.01f * static_cast<float>(f), 0.01f, 0}, f});
  picture.contacts.push_back({{0, -0.01f, 0}, std::nullopt});
  picture.skin_points.emplace_back(0.01f, -0.01f, 0.0f);
  const Pixels pixels = shoot(picture, large);
  for (std::uint32_t f = 0; f < 4; ++f)
    EXPECT_LE(distance(pixel_at(pixels, Vec3(picture.contacts[f].position)), finger_colour(f)), 12) << f;
  EXPECT_LE(distance(pixel_at(pixels, {0, -0.01, 0}), theme_of(false).loose_contact), 12);
  EXPECT_LE(distance(pixel_at(pixels, {0.01, -0.01, 0}), theme_of(false).skin_point), 30);
}

TEST_F(Renderer, TransducersShowTheirDriveFromTheFrontOnly) {
  Picture picture;
  picture.driven = true;
  picture.transducers = {{{-0.02f, 0, 0}, {0, 0, 1}, 1.0f, 0.5f},
                         {{0, 0, 0}, {0, 0, 1}, 0.3f, -2.0f},
                         {{0.02f, 0, 0}, {0, 0, -1}, 1.0f, 0.5f}};
  const Pixels pixels = shoot(picture);
  const Colour loud = drive_colour(1.0f, 0.5f);
  for (const auto& [at, colour, within] : {std::tuple(Vec3(-0.02, 0, 0), loud, 2),
                                           {Vec3(0, 0, 0), drive_colour(0.3f, -2.0f), 2},
                                           {Vec3(0.02, 0, 0), paper(), 1},
                                           {Vec3(-0.02, 0.0036, 0), loud, 2},  // as large as the transducer: 4.2 mm
                                           {Vec3(-0.02, 0.0052, 0), paper(), 1}})
    EXPECT_LE(distance(pixel_at(pixels, at), colour), within) << at.x << " " << at.y;
}

TEST_F(Renderer, TheSameSceneGivesTheSameBytesAlsoAfterAnUpdate) {
  Picture picture = test::cube_picture();
  show_array(picture, array::load_layout("autd3"));
  const Pixels first = shoot(picture, {.state = {}}), second = shoot(picture, {.state = {}});
  EXPECT_EQ(first.rgba, second.rgba);
  EXPECT_GT(test::count_not(first, paper()), 3000u);

  DrawnPicture drawn(test::test_device());
  Offscreen offscreen(test::test_device(), width, height);
  Picture other = picture;
  other.transducers.clear();
  drawn.update(other, {});
  offscreen.draw(drawn, test::front_viewpoint());
  EXPECT_NE(offscreen.pixels().rgba, first.rgba);
  drawn.update_marks(picture);
  offscreen.draw(drawn, test::front_viewpoint());
  // They are the same except for the floor, which follows the solids.
  EXPECT_EQ(offscreen.pixels().rgba, first.rgba);
}

TEST_F(Renderer, ASkinThatChangesLeavesSolidsAlone) {
  Picture picture = test::cube_picture();
  picture.skin = SurfaceMark{"finger", test::box({-0.01, 0.01, -0.01}, {0.01, 0.03, 0.01})};
  Picture moved = picture;
  moved.skin->mesh = test::box({0, 0.01, -0.01}, {0.02, 0.03, 0.01});
  const Pixels after = shoot(moved);
  ASSERT_NE(after.rgba, shoot(picture).rgba);

  DrawnPicture drawn(test::test_device());
  Offscreen offscreen(test::test_device(), width, height);
  drawn.update(picture, test::bare_view());
  const auto redrawn = [&](const Picture& skin_alone) {
    drawn.update_skin(skin_alone, test::bare_view());
    offscreen.draw(drawn, test::front_viewpoint());
    return offscreen.pixels().rgba;
  };
  moved.solids.clear();
  EXPECT_EQ(redrawn(moved), after.rgba);
  EXPECT_EQ(redrawn({}), shoot(test::cube_picture()).rgba);
}

// Lines, rings and points have soft edges by themselves. With a single sample, only edges of surfaces are rough.
TEST_F(Renderer, AQuickPictureIsTheFineOneButForEdges) {
  Picture picture = test::cube_picture();
  picture.skin_points = {{0.03f, 0, 0.02f}, {0.031f, 0.001f, 0.02f}};
  picture.fingers.resize(1);
  picture.fingers[0].foci = {{{0, 0.02f, 0}, 1, true}};
  show_array(picture, array::load_layout("autd3"));
  Shot shot{.state = {}};
  shot.viewpoint.azimuth = 0.4;
  shot.viewpoint.elevation = 0.3;
  const Pixels fine = shoot(picture, shot);
  shot.fineness = Fineness::quick;
  const Pixels quick = shoot(picture, shot);
  EXPECT_NE(quick.rgba, fine.rgba);
  std::size_t same = 0;
  for (std::size_t i = 0; i < fine.rgba.size(); i += 4)
    same += std::abs(fine.rgba[i] - quick.rgba[i]) <= 2;
  EXPECT_GT(same, 8 * width * height / 10);
  EXPECT_LT(mean_difference(fine, quick), 0.02);
}

TEST_F(Renderer, AQuickPictureShowsOnlySomeOfVeryManyPoints) {
  const auto drawn_of = [](int side, Fineness fineness) {  // this many points along a side, four pixels apart
    Picture picture;
    for (int i = 0; i < side * side; ++i)
      picture.skin_points.emplace_back((i % side - side / 2) * 4e-4f, (i / side - side / 2) * 4e-4f, 0);
    Shot shot{.width = 1280, .height = 1280, .fineness = fineness};
    shot.viewpoint.orthographic = true;
    shot.viewpoint.distance = 0.4;
    return static_cast<double>(test::count_not(shoot(picture, shot), paper()));
  };
  EXPECT_NEAR(drawn_of(120, Fineness::quick) / drawn_of(120, Fineness::fine), 1, 0.1);
  EXPECT_LT(drawn_of(240, Fineness::quick), 0.7 * drawn_of(240, Fineness::fine)) << "57,600, of which each second";
}

TEST_F(Renderer, TheLegendCountsSkinThatIsTooFarAwayToBeDrawn) {
  Picture picture = test::cube_picture();
  const std::size_t without = test::count_not(shoot(picture, {.state = {}}), paper());
  picture.skin_count = 61'396;
  EXPECT_GT(test::count_not(shoot(picture, {.state = {}}), paper()), without + 100);
}

TEST_F(Renderer, ASettledSceneAllocatesNothing) {
  gpu::Device& device = test::test_device();
  Picture picture = test::cube_picture();
  picture.fingers.resize(1);
  picture.fingers[0].foci = {{{0, 0, 0}, 1, true}, {{0.01f, 0, 0}, 2, true}};
  DrawnPicture drawn(device);
  drawn.update(picture);
  Offscreen offscreen(device, width, height);
  offscreen.draw(drawn, test::front_viewpoint());
  const std::uint64_t allocations = device.memory_allocations, pipelines = device.pipelines_created;
  for (std::uint32_t slot = 0; slot < 5; ++slot) {
    picture.fingers[0].running = slot % 2;
    drawn.update_marks(picture);
    offscreen.draw(drawn, test::front_viewpoint());
  }
  EXPECT_EQ(device.memory_allocations, allocations);
  EXPECT_EQ(device.pipelines_created, pipelines);
}

TEST_F(Renderer, AnInsetIsAPictureInThePicture) {
  Picture picture = test::cube_picture();
  picture.fingers.resize(1);
  picture.fingers[0].foci = {{{0, 0, 0}, 1, false}};  // the current one has no number to hide its colour
  picture.fingers[0].running = 0;
  DrawnPicture drawn(test::test_device());
  drawn.update(picture, test::bare_view());
  Offscreen offscreen(test::test_device(), 640, 480);
  const Viewpoint viewpoint = test::front_viewpoint();
  const std::vector<View> views{whole(viewpoint, 640, 480),
                                close_up(viewpoint, Box{Vec3(-0.002), Vec3(0.002)}, 640, 480, 1)};
  offscreen.draw(drawn, views);
  const Pixels both = offscreen.pixels(), alone = shoot(picture, large);
  const VkRect2D& area = views[1].area;
  const auto x = static_cast<std::uint32_t>(area.offset.x), y = static_cast<std::uint32_t>(area.offset.y);
  EXPECT_NEAR(area.extent.width, 640 * inset_share, 1);
  EXPECT_LT(x + area.extent.width, 640u);
  EXPECT_LT(y + area.extent.height, 480u);
  std::size_t outside = 0;
  for (std::uint32_t v = 0; v < 480; ++v) {
    for (std::uint32_t u = 0; u < 640; ++u) {
      const bool inside = u >= x && v >= y && u < x + area.extent.width && v < y + area.extent.height;
      outside += !inside && !std::equal(both.at(u, v), both.at(u, v) + 3, alone.at(u, v));
    }
  }
  EXPECT_EQ(outside, 0u);
  // Its overlay is in the same place: the border, and a focus in its middle.
  EXPECT_LT(both.at(x, y + area.extent.height / 2)[0], 170);
  EXPECT_LE(distance(both.at(x + area.extent.width / 2, y + area.extent.height / 2), finger_colour(0)), 8);
  // The close-up shows the cube's middle all over: no background inside its border.
  for (std::uint32_t v = 4; v + 4 < area.extent.height; v += 7) {
    for (std::uint32_t u = 4; u + 4 < area.extent.width; u += 7)
      ASSERT_GT(distance(both.at(x + u, y + v), paper()), 20) << u << " " << v;
  }
  // Panels and colour bars cover the whole picture, and nothing of the close-up.
  Viewpoint covered = viewpoint;
  covered.covered_left = 0.2;
  covered.covered_right = 0.3;
  cover_below(covered, 0.1, false);
  const View free = close_up(covered, Box{Vec3(-0.002), Vec3(0.002)}, 640, 480, 1);
  EXPECT_EQ(free.area.offset.y, area.offset.y);
  EXPECT_NEAR(free.viewpoint.distance, views[1].viewpoint.distance, 1e-12);
  const Projected middle = project(projection(free.viewpoint, area.extent.width, area.extent.height), Vec3(0));
  EXPECT_NEAR(middle.x, area.extent.width / 2.0, 0.1);
  EXPECT_NEAR(middle.y, area.extent.height / 2.0, 0.1);
  // Beside the cube, nothing but the paper.
  const Box beside{Vec3(0.048, 0.048, -0.002), Vec3(0.052, 0.052, 0.002)};
  offscreen.draw(drawn, std::vector<View>{views[0], close_up(viewpoint, beside, 640, 480, 1)});
  EXPECT_LE(distance(offscreen.pixels().at(x + area.extent.width / 2, y + area.extent.height / 2), paper()), 1);
}

TEST_F(Renderer, LinesAreCutWhereTheyPassBehindTheEye) {
  Picture picture;
  CameraMark mark;  // four lines from behind the viewer's right shoulder to a point ahead on the right
  mark.apex = {0.01f, 0, 0.1f};
  mark.corners.fill({0.01f, 0, -0.1f});
  picture.cameras.push_back(mark);
  Shot shot{.viewpoint = {}};
  look(shot.viewpoint, Vec3(0), Vec3(0, 0, -1));
  shot.state.layers[Layer::cameras].visible = true;
  const Pixels pixels = shoot(picture, shot);
  const Projected end = project(projection(shot.viewpoint, width, height), {0.01, 0, -0.1});
  const auto darkest = [&](double from, double to) {
    int dark = 255;
    for (auto x = static_cast<std::uint32_t>(from); x < static_cast<std::uint32_t>(to); ++x)
      dark = std::min<int>({dark, pixels.at(x, height / 2 - 1)[0], pixels.at(x, height / 2)[0]});
    return dark;
  };
  EXPECT_LT(darkest(end.x + 4, end.x + 8), 200);
  EXPECT_LT(darkest(width - 6, width - 1), 200) << "continues to the picture's edge";
  EXPECT_EQ(darkest(0, end.x - 8), 255) << "and does not reach the other side";
}

TEST_F(Renderer, AbsurdSizesAreFailures) {
  for (const auto& [w, h] : {std::pair(0u, 10u), std::pair(10u, 0u), std::pair(1'000'000u, 10u)})
    EXPECT_NE(test::error_of([&, w = w, h = h] { const Offscreen o(test::test_device(), w, h); }, Exit::failed), "")
        << w << "x" << h;
}

TEST_F(Renderer, HugeAndBrokenCoordinatesDoNotHang) {
  Picture picture = test::cube_picture();
  const float inf = std::numeric_limits<float>::infinity(), nan = std::numeric_limits<float>::quiet_NaN();
  for (const float v : {1e30f, inf, nan}) {
    picture.skin_points.emplace_back(v, 0.0f, v);
    picture.contacts.push_back({{v, v, 0}, 0u});
    picture.transducers.push_back({{v, 0, 0}, {v, v, v}, v, v});
  }
  picture.fingers.resize(1);
  picture.fingers[0].foci = {{{inf, 0, 0}, 1, true}, {{nan, 0, 0}, 2, true}, {{0, 0, 0}, 3, true}};
  EXPECT_LT(distance(pixel_at(shoot(picture, {.state = {}}), {0.0185, 0.0185, 0.02}), theme_of(false).solid), 120);
  picture.solids.clear();  // now the floor lies under the points
  EXPECT_EQ(shoot(picture, {.state = {}}).width, width);
}

}  // namespace
}  // namespace palpa::viewer
