#include <gtest/gtest.h>

#include <cstdlib>
#include <glm/geometric.hpp>
#include <limits>

#include "base/error.hpp"
#include "drawing_test.hpp"
#include "support/device.hpp"
#include "viewer/picture/palette.hpp"
#include "viewer/render/offscreen.hpp"
#include "viewer/scenes.hpp"

namespace palpa::viewer {
namespace {

using Renderer = test::DrawingTest;

constexpr std::uint32_t width = 320, height = 240;

Pixels draw(const Picture& picture, const Viewpoint& viewpoint, std::uint32_t w = width, std::uint32_t h = height,
            const ViewState& state = test::bare_view()) {
  DrawnPicture drawn(test::test_device());
  drawn.update(picture, state);
  Offscreen offscreen(test::test_device(), w, h);
  offscreen.draw(drawn, viewpoint);
  return offscreen.pixels();
}

/// Largest difference of a channel, in steps of 255.
int distance(const std::uint8_t* pixel, const Colour& colour) {
  const float channels[3] = {colour.r, colour.g, colour.b};
  int worst = 0;
  for (int i = 0; i < 3; ++i)
    worst = std::max(worst, std::abs(static_cast<int>(std::lround(channels[i] * 255)) - pixel[i]));
  return worst;
}

const std::uint8_t* at(const Pixels& pixels, const Viewpoint& viewpoint, const Vec3& world) {
  const Projected p = project(projection(viewpoint, pixels.width, pixels.height), world);
  EXPECT_TRUE(p.visible && p.x >= 0 && p.y >= 0 && p.x < pixels.width && p.y < pixels.height);
  return pixels.at(static_cast<std::uint32_t>(p.x), static_cast<std::uint32_t>(p.y));
}

std::size_t count_not(const Pixels& pixels, const Colour& colour) {
  std::size_t n = 0;
  for (std::uint32_t y = 0; y < pixels.height; ++y) {
    for (std::uint32_t x = 0; x < pixels.width; ++x)
      n += distance(pixels.at(x, y), colour) > 1;
  }
  return n;
}

TEST_F(Renderer, AnEmptySceneIsBackground) {
  Picture picture;
  EXPECT_EQ(count_not(draw(picture, test::front_viewpoint()), theme_of(false).background), 0u);
  ViewState dark = test::bare_view();
  dark.dark = true;
  EXPECT_EQ(count_not(draw(picture, test::front_viewpoint(), width, height, dark), theme_of(true).background), 0u);
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

TEST_F(Renderer, ACubeIsWhereItShouldBeAndTranslucent) {
  const Viewpoint viewpoint = test::front_viewpoint();
  const Pixels pixels = draw(test::cube_picture(), viewpoint);
  // The back face, then the front face, each the solid's colour under the light of mesh.frag, over the background.
  const Theme& theme = theme_of(false);
  const float light = 0.62f + 0.26f + 0.16f * 0.5f;
  const Colour lit{theme.solid.r * light, theme.solid.g * light, theme.solid.b * light, 1};
  const Colour expected = mix(mix(theme.background, lit, theme.solid.a), lit, theme.solid.a);
  EXPECT_LE(distance(at(pixels, viewpoint, {0.003, 0.004, 0.02}), expected), 3);
  // Its front face ends at 0.02 m, 0.18 m in front of the eye. Just outside, there is background; on the rim, a dark
  // edge.
  EXPECT_LE(distance(at(pixels, viewpoint, {0.0225, 0.004, 0.02}), theme.background), 1);
  EXPECT_LE(distance(at(pixels, viewpoint, {0.018, 0.004, 0.02}), expected), 40);
  EXPECT_LT(at(pixels, viewpoint, {0.02, 0.005, 0.02})[0], 140);
  EXPECT_LT(at(pixels, viewpoint, {-0.02, -0.005, 0.02})[0], 140);
}

TEST_F(Renderer, HiddenEdgesAreFaint) {
  const Viewpoint viewpoint = test::front_viewpoint();
  const Pixels pixels = draw(test::cube_picture(), viewpoint);
  // The back face's edges show through the front face: lighter than the front face's own edges, and darker than the
  // face.
  const int face = at(pixels, viewpoint, {0.003, 0.004, 0.02})[0];
  const int hidden = at(pixels, viewpoint, {0.0, 0.02, -0.02})[0];
  const int shown = at(pixels, viewpoint, {0.0, 0.02, 0.02})[0];
  EXPECT_LT(hidden, face - 15);
  EXPECT_LT(shown, hidden - 30);
}

TEST_F(Renderer, ASmoothSolidHasAnOutlineAndNoInnerEdges) {
  Picture picture;
  geometry::Mesh ball;  // rings of a sphere of 2 cm
  constexpr unsigned rings = 32, around = 64;
  for (unsigned i = 0; i <= rings; ++i) {
    for (unsigned j = 0; j < around; ++j) {
      const double t = M_PI * i / rings, p = 2 * M_PI * j / around;
      ball.positions.emplace_back(0.02 * std::sin(t) * std::cos(p), 0.02 * std::cos(t),
                                  0.02 * std::sin(t) * std::sin(p));
    }
  }
  for (unsigned i = 0; i < rings; ++i) {
    for (unsigned j = 0; j < around; ++j) {
      const unsigned a = i * around + j, b = i * around + (j + 1) % around;
      ball.triangles.push_back({a, b, a + around});
      ball.triangles.push_back({b, b + around, a + around});
    }
  }
  picture.solids.push_back({"ball", ball});
  const Viewpoint viewpoint = test::front_viewpoint();
  const Pixels pixels = draw(picture, viewpoint, 640, 480);
  int darkest_inside = 255, darkest_rim = 255;
  for (double r = 0; r < 0.0225; r += 5e-5) {
    const int red = at(pixels, viewpoint, {r * 0.8, r * 0.6, 0})[0];
    int& darkest = r < 0.018 ? darkest_inside : darkest_rim;
    darkest = std::min(darkest, red);
  }
  EXPECT_GT(darkest_inside, 150);
  EXPECT_LT(darkest_rim, 110);
}

TEST_F(Renderer, ContactsHaveTheirFingersColour) {
  Picture picture;
  for (std::uint32_t f = 0; f < 4; ++f) {
    picture.contacts.push_back({{-0.015f + 0.01f * static_cast<float>(f), 0.01f, 0}, f});
  }
  picture.contacts.push_back({{0, -0.01f, 0}, std::nullopt});
  picture.skin_points.emplace_back(0.01f, -0.01f, 0.0f);
  const Viewpoint viewpoint = test::front_viewpoint();
  const Pixels pixels = draw(picture, viewpoint, 640, 480);
  for (std::uint32_t f = 0; f < 4; ++f) {
    EXPECT_LE(distance(at(pixels, viewpoint, Vec3(picture.contacts[f].position)), finger_colour(f)), 12) << f;
  }
  EXPECT_LE(distance(at(pixels, viewpoint, {0, -0.01, 0}), theme_of(false).loose_contact), 12);
  EXPECT_LE(distance(at(pixels, viewpoint, {0.01, -0.01, 0}), theme_of(false).skin_point), 30);
}

TEST_F(Renderer, AContactInsideASolidShowsThroughItAndOneBehindItToo) {
  Picture picture = test::cube_picture();
  picture.contacts.push_back({{0.005f, 0.005f, 0.01f}, 0u});
  picture.contacts.push_back({{-0.008f, 0.005f, 0.03f}, 0u});  // in front of the front face
  const Viewpoint viewpoint = test::front_viewpoint();
  const Pixels pixels = draw(picture, viewpoint, 640, 480);
  const std::uint8_t* inside = at(pixels, viewpoint, {0.005, 0.005, 0.01});
  EXPECT_GT(inside[0], inside[2] + 60);                                                     // still orange
  EXPECT_GT(distance(inside, finger_colour(0)), 15);                                        // but veiled
  EXPECT_LE(distance(at(pixels, viewpoint, {-0.008, 0.005, 0.03}), finger_colour(0)), 12);  // not this one
}

TEST_F(Renderer, FociLieOnTopWithTheRunningOneFilled) {
  Picture picture = test::cube_picture();
  picture.fingers.resize(1);
  picture.fingers[0].foci = {{{-0.012f, 0, 0}, 1, true}, {{0.012f, 0, 0}, 2, true}, {{0, 0.012f, 0}, 3, true}};
  picture.fingers[0].running = 1;
  const Viewpoint viewpoint = test::front_viewpoint();
  const Pixels pixels = draw(picture, viewpoint, 640, 480);
  const auto view = projection(viewpoint, 640, 480);
  const auto beside = [&](const Vec3& p, double dx) {
    const Projected q = project(view, p);
    return pixels.at(static_cast<std::uint32_t>(q.x + dx), static_cast<std::uint32_t>(q.y));
  };
  // Seven pixels from its centre: inside the disc, beside the number.
  EXPECT_LE(distance(beside({-0.012, 0, 0}, -7), rgb(0xffffff)), 8);
  EXPECT_LE(distance(beside({0.012, 0, 0}, 7), finger_colour(0)), 8);
  // The numbers: dark on the waiting ones, white on the running one.
  const auto extreme = [&](const Vec3& p, bool dark) {
    int found = dark ? 255 : 0;
    const Projected q = project(view, p);
    for (int dy = -5; dy <= 5; ++dy) {
      for (int dx = -5; dx <= 5; ++dx) {
        const int blue = pixels.at(static_cast<std::uint32_t>(q.x + dx), static_cast<std::uint32_t>(q.y + dy))[2];
        found = dark ? std::min(found, blue) : std::max(found, blue);
      }
    }
    return found;
  };
  EXPECT_LT(extreme({-0.012, 0, 0}, true), 90);
  EXPECT_GT(extreme({0.012, 0, 0}, false), 200);
}

TEST_F(Renderer, TransducersShowTheirDriveFromTheFrontOnly) {
  Picture picture;
  picture.driven = true;
  picture.transducers = {{{-0.02f, 0, 0}, {0, 0, 1}, 1.0f, 0.5f},
                         {{0, 0, 0}, {0, 0, 1}, 0.3f, -2.0f},
                         {{0.02f, 0, 0}, {0, 0, -1}, 1.0f, 0.5f}};
  const Viewpoint viewpoint = test::front_viewpoint();
  const Pixels pixels = draw(picture, viewpoint);
  EXPECT_LE(distance(at(pixels, viewpoint, {-0.02, 0, 0}), drive_colour(1.0f, 0.5f)), 2);
  EXPECT_LE(distance(at(pixels, viewpoint, {0, 0, 0}), drive_colour(0.3f, -2.0f)), 2);
  EXPECT_LE(distance(at(pixels, viewpoint, {0.02, 0, 0}), theme_of(false).background), 1);
  // As large as the transducer: 4.2 mm.
  EXPECT_LE(distance(at(pixels, viewpoint, {-0.02, 0.0036, 0}), drive_colour(1.0f, 0.5f)), 2);
  EXPECT_LE(distance(at(pixels, viewpoint, {-0.02, 0.0052, 0}), theme_of(false).background), 1);
}

TEST_F(Renderer, TheSkinIsFaintAndPassesThroughTheSolid) {
  Picture picture = test::cube_picture();
  picture.skin = SurfaceMark{"skin", test::box({-0.008, -0.008, 0.0}, {0.008, 0.03, 0.03})};
  const Viewpoint viewpoint = test::front_viewpoint();
  const Pixels with = draw(picture, viewpoint), without = draw(test::cube_picture(), viewpoint);
  const int change = std::abs(at(with, viewpoint, {0, 0.001, 0.03})[2] - at(without, viewpoint, {0, 0.001, 0.03})[2]);
  EXPECT_GT(change, 3);
  EXPECT_LT(change, 60);
  EXPECT_GT(distance(at(with, viewpoint, {0, 0.027, 0.03}), theme_of(false).background), 5);  // above the cube
}

TEST_F(Renderer, TheSameSceneGivesTheSameBytesAlsoAfterAnUpdate) {
  Picture picture = test::cube_picture();
  show_array(picture, array::load_layout("autd3"));
  const Viewpoint viewpoint = test::front_viewpoint();
  const Pixels first = draw(picture, viewpoint, width, height, {}),
               second = draw(picture, viewpoint, width, height, {});
  EXPECT_EQ(first.rgba, second.rgba);
  EXPECT_GT(count_not(first, theme_of(false).background), 3000u);

  DrawnPicture drawn(test::test_device());
  Offscreen offscreen(test::test_device(), width, height);
  Picture other = picture;
  other.transducers.clear();
  drawn.update(other, {});
  offscreen.draw(drawn, viewpoint);
  EXPECT_NE(offscreen.pixels().rgba, first.rgba);
  drawn.update_marks(picture);
  offscreen.draw(drawn, viewpoint);
  // They are the same except for the floor, which follows the solids.
  EXPECT_EQ(offscreen.pixels().rgba, first.rgba);
}

TEST_F(Renderer, ASkinThatChangesLeavesSolidsAlone) {
  Picture picture = test::cube_picture();
  picture.skin = SurfaceMark{"finger", test::box({-0.01, 0.01, -0.01}, {0.01, 0.03, 0.01})};
  const Viewpoint viewpoint = test::front_viewpoint();
  const Pixels before = draw(picture, viewpoint);
  Picture moved = picture;
  moved.skin->mesh = test::box({0, 0.01, -0.01}, {0.02, 0.03, 0.01});
  const Pixels after = draw(moved, viewpoint);
  ASSERT_NE(after.rgba, before.rgba);

  DrawnPicture drawn(test::test_device());
  Offscreen offscreen(test::test_device(), width, height);
  drawn.update(picture, test::bare_view());
  Picture skin_alone = moved;
  skin_alone.solids.clear();
  drawn.update_skin(skin_alone, test::bare_view());
  offscreen.draw(drawn, viewpoint);
  EXPECT_EQ(offscreen.pixels().rgba, after.rgba);
  skin_alone.skin.reset();
  drawn.update_skin(skin_alone, test::bare_view());
  offscreen.draw(drawn, viewpoint);
  EXPECT_EQ(offscreen.pixels().rgba, draw(test::cube_picture(), viewpoint).rgba);
}

// Lines, rings and points have soft edges by themselves. With a single sample, only edges of surfaces are rough.
TEST_F(Renderer, AQuickPictureIsTheFineOneButForEdges) {
  Picture picture = test::cube_picture();
  picture.skin_points = {{0.03f, 0, 0.02f}, {0.031f, 0.001f, 0.02f}};
  picture.fingers.resize(1);
  picture.fingers[0].foci = {{{0, 0.02f, 0}, 1, true}};
  show_array(picture, array::load_layout("autd3"));
  Viewpoint viewpoint = test::front_viewpoint();
  viewpoint.azimuth = 0.4;
  viewpoint.elevation = 0.3;
  DrawnPicture drawn(test::test_device());
  drawn.update(picture);
  const auto draw = [&](Fineness fineness) {
    Offscreen offscreen(test::test_device(), width, height, 1, fineness);
    offscreen.draw(drawn, viewpoint);
    return offscreen.pixels();
  };
  const Pixels fine = draw(Fineness::fine), quick = draw(Fineness::quick);
  EXPECT_NE(quick.rgba, fine.rgba);
  std::size_t same = 0;
  for (std::size_t i = 0; i < fine.rgba.size(); i += 4)
    same += std::abs(fine.rgba[i] - quick.rgba[i]) <= 2;
  EXPECT_GT(same, 8 * width * height / 10);
  EXPECT_LT(mean_difference(fine, quick), 0.02);
}

TEST_F(Renderer, AQuickPictureHasOfVeryManyPointsEachSoManyth) {
  const auto drawn_of = [](int side, Fineness fineness) {  // this many points along a side, four pixels apart
    Picture picture;
    for (int i = 0; i < side * side; ++i)
      picture.skin_points.emplace_back((i % side - side / 2) * 4e-4f, (i / side - side / 2) * 4e-4f, 0);
    Viewpoint viewpoint = test::front_viewpoint();
    viewpoint.orthographic = true;
    viewpoint.distance = 0.4;
    DrawnPicture drawn(test::test_device());
    drawn.update(picture, test::bare_view());
    Offscreen offscreen(test::test_device(), 1280, 1280, 1, fineness);
    offscreen.draw(drawn, viewpoint);
    return static_cast<double>(count_not(offscreen.pixels(), theme_of(false).background));
  };
  EXPECT_NEAR(drawn_of(120, Fineness::quick) / drawn_of(120, Fineness::fine), 1, 0.1);
  EXPECT_LT(drawn_of(240, Fineness::quick), 0.7 * drawn_of(240, Fineness::fine)) << "57,600, of which each second";
}

TEST_F(Renderer, TheLegendCountsSkinThatIsTooFarAwayToBeDrawn) {
  Picture picture = test::cube_picture();
  const Viewpoint viewpoint = test::front_viewpoint();
  const Pixels without = draw(picture, viewpoint, width, height, {});
  picture.skin_count = 61'396;
  const Pixels with = draw(picture, viewpoint, width, height, {});
  EXPECT_GT(count_not(with, theme_of(false).background), count_not(without, theme_of(false).background) + 100);
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
  Box box;
  box.add({-0.002, -0.002, -0.002});
  box.add({0.002, 0.002, 0.002});
  const std::vector<View> views{whole(viewpoint, 640, 480), close_up(viewpoint, box, 640, 480, 1)};
  offscreen.draw(drawn, views);
  const Pixels both = offscreen.pixels();
  offscreen.draw(drawn, viewpoint);
  const Pixels alone = offscreen.pixels();
  const VkRect2D& area = views[1].area;
  const auto x = static_cast<std::uint32_t>(area.offset.x), y = static_cast<std::uint32_t>(area.offset.y);
  EXPECT_NEAR(area.extent.width, 640 * inset_share, 1);
  EXPECT_LT(x + area.extent.width, 640u);
  EXPECT_LT(y + area.extent.height, 480u);
  std::size_t outside = 0;
  for (std::uint32_t v = 0; v < 480; ++v) {
    for (std::uint32_t u = 0; u < 640; ++u) {
      const bool inside = u >= x && v >= y && u < x + area.extent.width && v < y + area.extent.height;
      for (int c = 0; c < 3 && !inside; ++c)
        outside += both.at(u, v)[c] != alone.at(u, v)[c];
    }
  }
  EXPECT_EQ(outside, 0u);
  // Its overlay is in the same place: the border, and a focus in its middle.
  EXPECT_LT(both.at(x, y + area.extent.height / 2)[0], 170);
  EXPECT_LE(distance(both.at(x + area.extent.width / 2, y + area.extent.height / 2), finger_colour(0)), 8);
  // The close-up shows the cube's middle all over: no background inside its border.
  for (std::uint32_t v = 4; v + 4 < area.extent.height; v += 7) {
    for (std::uint32_t u = 4; u + 4 < area.extent.width; u += 7) {
      ASSERT_GT(distance(both.at(x + u, y + v), theme_of(false).background), 20) << u << " " << v;
    }
  }
}

TEST_F(Renderer, LinesAreCutWhereTheyPassBehindTheEye) {
  Picture picture;
  CameraMark mark;  // four lines from behind the viewer's right shoulder to a point ahead on the right
  mark.apex = {0.01f, 0, 0.1f};
  mark.corners.fill({0.01f, 0, -0.1f});
  picture.cameras.push_back(mark);
  Viewpoint viewpoint;
  look(viewpoint, Vec3(0), Vec3(0, 0, -1));
  ViewState state = test::bare_view();
  state.layers[Layer::cameras].visible = true;
  const Pixels pixels = draw(picture, viewpoint, width, height, state);
  const Projected end = project(projection(viewpoint, width, height), {0.01, 0, -0.1});
  const auto darkest = [&](double from, double to) {
    int dark = 255;
    for (auto x = static_cast<std::uint32_t>(from); x < static_cast<std::uint32_t>(to); ++x) {
      for (std::uint32_t y = height / 2 - 1; y <= height / 2; ++y)
        dark = std::min<int>(dark, pixels.at(x, y)[0]);
    }
    return dark;
  };
  EXPECT_LT(darkest(end.x + 4, end.x + 8), 200);
  EXPECT_LT(darkest(width - 6, width - 1), 200);  // continues to the picture's edge
  EXPECT_EQ(darkest(0, end.x - 8), 255);          // and does not reach the other side
}

TEST_F(Renderer, AbsurdSizesAreFailures) {
  for (const auto& [w, h] : {std::pair(0u, 10u), std::pair(10u, 0u), std::pair(1'000'000u, 10u)}) {
    try {
      const Offscreen offscreen(test::test_device(), w, h);
      ADD_FAILURE() << w << "x" << h;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), Exit::failed);
    }
  }
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
  const Pixels pixels = draw(picture, test::front_viewpoint(), width, height, {});
  EXPECT_LT(distance(at(pixels, test::front_viewpoint(), {0.0185, 0.0185, 0.02}), theme_of(false).solid), 120);
  picture.solids.clear();  // now the floor lies under the points
  EXPECT_EQ(draw(picture, test::front_viewpoint(), width, height, {}).width, width);
}

}  // namespace
}  // namespace palpa::viewer
