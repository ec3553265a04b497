#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>
#include <tuple>
#include <vector>

#include "drawing/font.hpp"
#include "drawing/ink.hpp"
#include "session/plan/voice.hpp"
#include "support/cameras.hpp"
#include "touch/fingers/sight.hpp"
#include "viewer/picture/colour_bars.hpp"
#include "viewer/picture/palette.hpp"
#include "viewer/picture/picture.hpp"
#include "viewer/render/overlay.hpp"
#include "viewer/scenes.hpp"

namespace palpa::viewer {
namespace {

/// Two fingers, one with four sectors, the last of them empty, and one that is a single point; and a contact of no
/// finger.
struct Example {
  std::vector<geometry::Solid> solids;
  std::vector<sensing::SkinPoint> points;
  touch::Touch touch;
  array::Schedule schedule;
  std::vector<touch::Placement> placements{2};

  Example() {
    solids.resize(1);
    solids[0].name = "block";
    solids[0].mesh = test::box({-0.02, -0.04, -0.02}, {0.02, 0, 0.02});
    for (std::uint32_t i = 0; i < 12; ++i)
      points.push_back({{0.001f * static_cast<float>(i), 0, 0}, 10 * i});
    for (const std::uint32_t i : {1, 2, 3, 5, 7, 8})
      touch.contacts.push_back({10 * i, 0, 1e-3f, points[i].position});
    touch.fingers.resize(3);
    touch.finger_count = 2;  // the third is a leftover from an earlier frame
    touch.fingers[0].contacts = {0, 1, 2};
    touch.fingers[0].section.axes = {glm::vec3(1, 0, 0), glm::vec3(0, 0, -1), glm::vec3(0, 1, 0)};
    for (std::uint32_t n = 0; n < 4; ++n) {
      touch.fingers[0].foci.push_back({{0.001f * static_cast<float>(n), 0, 0.002f}, n == 3 ? 0u : 1u});
    }
    touch.fingers[1].contacts = {4, 5};
    touch.fingers[1].point_like = true;
    touch.fingers[1].section.centroid = {0.0075f, 0, 0};
    touch.fingers[1].foci.push_back({{0.0075f, 0, 0}, 2});
    schedule.slot_s = 1.5e-3;
    for (std::uint32_t f = 0; f < 2; ++f) {
      touch::place_foci(touch, touch.fingers[f], {}, placements[f]);
      session::make_voice(placements[f], f, 0, {.stride = 3}, schedule.add_voice());
    }
  }
};

TEST(Picture, ContactsCarryTheirFingerAndAreNoSkinPoints) {
  const Example example;
  Picture picture;
  show_solids(picture, example.solids);
  show_touch(picture, example.solids, example.points, example.touch);
  EXPECT_EQ(picture.skin_points.size(), 6u);
  ASSERT_EQ(picture.contacts.size(), 6u);
  EXPECT_EQ(picture.contacts[0].finger, 0u);
  EXPECT_EQ(picture.contacts[2].finger, 0u);
  EXPECT_FALSE(picture.contacts[3].finger);
  EXPECT_EQ(picture.contacts[4].finger, 1u);
  ASSERT_EQ(picture.fingers.size(), 2u);
  EXPECT_EQ(picture.fingers[0].solid, "block");
  EXPECT_EQ(picture.fingers[0].contacts, 3u);
}

TEST(Picture, FociFollowTheOrderAndTheSlotCounterRunsOn) {
  const Example example;
  Picture picture;
  show_touch(picture, example.solids, example.points, example.touch);
  show_schedule(picture, example.schedule, example.placements);
  const auto& foci = picture.fingers[0].foci;
  ASSERT_EQ(foci.size(), 4u);  // order 0 3 2 1
  EXPECT_FLOAT_EQ(foci[0].position.x, 0.0f);
  EXPECT_FLOAT_EQ(foci[2].position.x, 0.002f);
  EXPECT_FLOAT_EQ(foci[3].position.x, 0.001f);
  for (std::uint32_t i = 0; i < 4; ++i)
    EXPECT_EQ(foci[i].number, i + 1);
  EXPECT_TRUE(foci[0].own);
  EXPECT_FALSE(foci[1].own);  // sector 3 is empty
  ASSERT_EQ(picture.fingers[1].foci.size(), 1u);
  EXPECT_TRUE(picture.fingers[1].foci[0].own);

  for (const std::uint64_t slot : {0ull, 3ull, 4ull, 1'000'000'007ull}) {
    show_slot(picture, example.schedule, slot);
    EXPECT_EQ(picture.fingers[0].running, slot % 4);
    EXPECT_EQ(picture.fingers[1].running, 0u);
    std::vector<array::SlotFocus> sounding;
    array::foci_of_slot(example.schedule, slot, sounding);
    EXPECT_EQ(glm::vec3(sounding[0].position), foci[*picture.fingers[0].running].position) << slot;
  }
}

TEST(Picture, CamerasAreFrustaInTheWorld) {
  sensing::Camera camera = test::pinhole("left", 800, 400, 400);
  camera.T_world_camera[3] = Vec4(1, 2, 3, 1);
  Picture picture;
  show_cameras(picture, std::span(&camera, 1));
  ASSERT_EQ(picture.cameras.size(), 1u);
  EXPECT_EQ(picture.cameras[0].apex, glm::vec3(1, 2, 3));
  EXPECT_NEAR(picture.cameras[0].corners[0].x, 1 - 0.08, 1e-6);
  EXPECT_NEAR(picture.cameras[0].corners[2].y, 2 + 0.04, 1e-6);
  EXPECT_NEAR(picture.cameras[0].corners[1].z, 3.08, 1e-6);
}

/// Unlike cameras and boards are each drawn as alone.
TEST(Picture, EachOfSeveralCamerasAndBoardsHasItsOwnMark) {
  std::vector<sensing::Camera> cameras{test::pinhole("left", 800, 400, 400), test::pinhole("right", 64, 48, 30),
                                       test::pinhole("tall", 100, 300, 200)};
  std::vector<sensing::DepthFrame> frames(3);
  array::Layout layout;
  for (std::size_t i = 0; i < 3; ++i) {
    const double own = static_cast<double>(i);
    cameras[i].T_world_camera = glm::rotate(Transform(1), 0.3 + own, Vec3(1, own, 2));
    cameras[i].T_world_camera[3] = Vec4(own, 2 - own, 3 + own, 1);
    cameras[i].cx += 3 + own;
    cameras[i].depth_unit_m = 1e-3 * (1 + own);
    frames[i].depth.assign(sensing::pixel_count(cameras[i]), static_cast<std::uint16_t>(300 + 100 * i));
    layout.boards.push_back({"openmpd", 0, 0, 0.1 + own, 0.2 + 3 * own, cameras[i].T_world_camera});
  }
  Picture all;
  show_array(all, layout);
  show_cameras(all, cameras);
  show_depth(all, cameras, frames);
  ASSERT_EQ(all.images.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    Picture alone;
    array::Layout one;
    one.boards = {layout.boards[i]};
    show_array(alone, one);
    show_cameras(alone, std::span(&cameras[i], 1));
    show_depth(alone, std::span(&cameras[i], 1), std::span(&frames[i], 1));
    EXPECT_EQ(all.boards[i], alone.boards[0]);
    EXPECT_EQ(all.cameras[i].name, cameras[i].name);
    EXPECT_EQ(all.cameras[i].apex, alone.cameras[0].apex);
    EXPECT_EQ(all.cameras[i].corners, alone.cameras[0].corners);
    EXPECT_EQ(all.images[i].corners, alone.images[0].corners);
    EXPECT_EQ(all.images[i].pixels, alone.images[0].pixels);
  }
}

TEST(Picture, ExtentsGrowFromTouchToAll) {
  const Example example;
  Picture picture;
  show_solids(picture, example.solids);
  show_touch(picture, example.solids, example.points, example.touch);
  picture.skin_points.emplace_back(0, 0.5, 0);  // the far end of the arm
  show_array(picture, array::load_layout("paper"));
  const Box touch = extent(picture, Extent::touch), objects = extent(picture, Extent::objects),
            all = extent(picture, Extent::all);
  EXPECT_LT(touch.high.x - touch.low.x, 0.012);
  EXPECT_NEAR(objects.low.y, -0.04, 1e-9);
  EXPECT_LT(objects.high.y, 0.03);
  EXPECT_NEAR(all.high.y, 0.5, 1e-6);
  EXPECT_NEAR(all.low.x, -0.2, 1e-6);
  EXPECT_TRUE(extent(Picture{}, Extent::touch).empty());
  for (int axis = 0; axis < 3; ++axis) {
    for (const float far : {-0.2F, 0.2F}) {
      glm::vec3& end = picture.skin_points.emplace_back(0);
      end[axis] = far;
      EXPECT_EQ(extent(picture, Extent::objects).low, objects.low) << axis;
      EXPECT_EQ(extent(picture, Extent::objects).high, objects.high) << axis;
    }
  }
}

/// Strokes of one colour around a place.
std::size_t count_near(const std::vector<shader::ViewStroke>& strokes, const Projected& at, double radius,
                       const Colour& colour) {
  std::size_t n = 0;
  for (const auto& s : strokes) {
    const bool near = std::hypot(s.from.x - at.x, s.from.y - at.y) < radius;
    n += near && s.colour.x == colour.r && s.colour.y == colour.g && s.colour.z == colour.b;
  }
  return n;
}

TEST(Picture, SaysWhatASolidIsToAFinger) {
  geometry::Haptics haptics;
  EXPECT_EQ(feel_of(haptics), "");
  haptics.stiffness = std::vector<geometry::DepthForce>{{0, 0.5}, {0.01, 0.5}};
  haptics.texture = {1, 0, 0};
  EXPECT_EQ(feel_of(haptics), "") << "as if it had none";
  haptics.stiffness->back().force = 1;
  EXPECT_EQ(feel_of(haptics), "spring");
  haptics.texture = {0.2, 1, 0.6};
  haptics.click.emplace();
  EXPECT_EQ(feel_of(haptics), "clicks, spring, texture");
  geometry::Solid solid;
  solid.name = "plate";
  solid.mesh = test::box({0, 0, 0}, {1, 1, 1});
  solid.haptics = haptics;
  Picture picture;
  show_solids(picture, {&solid, 1});
  ASSERT_EQ(picture.solids.size(), 1U);
  EXPECT_EQ(picture.solids[0].feel, "clicks, spring, texture");
}

TEST(Overlay, NamesSeveralSolidsWhereTheyAre) {
  Picture picture;
  picture.solids.push_back({.name = "left", .mesh = {}, .feel = "texture", .name_at = Vec3(-0.02, 0, 0)});
  const Viewpoint viewpoint = test::front_viewpoint();
  const auto view = projection(viewpoint, 640, 480);
  const auto near = [&](const Vec3& place) {
    std::vector<shader::ViewStroke> strokes;
    build_overlay(picture, {}, viewpoint, {640, 480, 1, false}, strokes);
    const Projected p = project(view, place);
    return std::ranges::count_if(strokes, [&](const shader::ViewStroke& s) {
      return std::abs(s.from.x - p.x) < 30 && s.from.y < p.y && s.from.y > p.y - 16;
    });
  };
  EXPECT_EQ(near({-0.02, 0, 0}), 0) << "one alone is named in the legend";
  picture.solids.push_back({.name = "right", .mesh = {}, .name_at = Vec3(0.02, 0, 0)});
  EXPECT_GT(near({-0.02, 0, 0}), 4);
  EXPECT_GT(near({0.02, 0, 0}), 4);
  EXPECT_EQ(near({0, -0.02, 0}), 0);
  for (int i = 0; i < 6; ++i)
    picture.solids.push_back({.name = "far", .mesh = {}, .name_at = Vec3(0, -0.03 - 0.001 * i, 0)});
  EXPECT_GT(near({0.02, 0, 0}), 4) << "eight";
  picture.solids.push_back({.name = "a ninth part", .mesh = {}, .part = 1});
  EXPECT_GT(near({0.02, 0, 0}), 4) << "a part has no name of its own";
  picture.solids.push_back({.name = "far", .mesh = {}, .name_at = Vec3(0, -0.04, 0)});
  EXPECT_EQ(near({0.02, 0, 0}), 0) << "nine are too many to be told apart";
}

/// Whether a text is written somewhere, in letters of that height.
bool is_written(const std::vector<shader::ViewStroke>& strokes, const std::string& text, double height) {
  std::vector<drawing::PenStroke> pen;
  drawing::write_text(text, {0, 0}, height, pen);
  for (std::size_t i = 0; i + pen.size() <= strokes.size(); ++i) {
    bool same = true;
    for (std::size_t k = 0; same && k < pen.size(); ++k) {
      const shader::ViewStroke &first = strokes[i], &here = strokes[i + k];
      same = glm::distance(Vec2(here.from.x - first.from.x, here.from.y - first.from.y), pen[k].from - pen[0].from) +
                 glm::distance(Vec2(here.to.x - first.from.x, here.to.y - first.from.y), pen[k].to - pen[0].from) <
             1e-2;
    }
    if (same) return true;
  }
  return false;
}

TEST(Overlay, TheScaleIsAsLongAsItSays) {
  for (const bool orthographic : {false, true}) {
    for (const double distance : {0.043, 0.37, 1.7}) {
      for (const auto& [width, height] : {std::pair(640.0, 480.0), {300.0, 500.0}}) {
        Viewpoint viewpoint = test::front_viewpoint();
        viewpoint.orthographic = orthographic;
        viewpoint.distance = distance;
        std::vector<shader::ViewStroke> strokes;
        build_overlay({}, {}, viewpoint, {width, height, 1, false}, strokes);
        const auto bar = std::ranges::find_if(strokes, [&, wide = width](const shader::ViewStroke& s) {
          return s.from.y == s.to.y && s.to.x == static_cast<float>(wide - 24) && s.to.x - s.from.x > 20;
        });
        ASSERT_NE(bar, strokes.end());
        const auto view = projection(viewpoint, width, height);
        const double pixels_per_mm =
            project(view, viewpoint.target + Vec3(1e-3, 0, 0)).x - project(view, viewpoint.target).x;
        const double mm = (bar->to.x - bar->from.x) / pixels_per_mm;
        EXPECT_TRUE(is_written(strokes, fmt::format("{:.3g} mm", mm), drawing::text_size))
            << mm << " " << orthographic << " " << distance;
      }
    }
  }
}

TEST(Overlay, MarksEveryFocusWhereItIsAndLeavesEmptySectorsOut) {
  Picture picture;
  picture.fingers.resize(1);
  for (std::uint32_t i = 0; i < 5; ++i) {
    const double a = 2 * std::numbers::pi * i / 5;
    picture.fingers[0].foci.push_back({{0.01 * std::cos(a), 0.01 * std::sin(a), 0}, i + 1, i != 3});
  }
  const Viewpoint viewpoint = test::front_viewpoint();
  std::vector<shader::ViewStroke> strokes;
  build_overlay(picture, {}, viewpoint, {640, 480, 1, false}, strokes);
  const auto view = projection(viewpoint, 640, 480);
  for (const FocusMark& focus : picture.fingers[0].foci) {
    const std::size_t marks = count_near(strokes, project(view, Vec3(focus.position)), 1.0, finger_colour(0));
    EXPECT_EQ(marks, focus.own ? 1u : 0u) << focus.number;
  }
  // The lines that join them, in order and closed.
  std::size_t lines = 0;
  for (const auto& s : strokes)
    lines += s.colour.w == 0.75f;
  EXPECT_EQ(lines, 5u);

  const std::size_t before = strokes.size();
  picture.fingers[0].running = 2;
  build_overlay(picture, {}, viewpoint, {640, 480, 1, false}, strokes);
  EXPECT_GT(strokes.size(), 2 * before - 10);  // added; the running one has its halo
}

TEST(Overlay, ColourBarsLeaveTheArrayFree) {
  array::Layout layout;
  for (const double x : {-0.1, 0.1}) {
    for (const double z : {-0.1, 0.1})
      layout.transducers.push_back({.position = {x, 0, z}, .axis = {0, 1, 0}});
  }
  Picture picture;
  show_array(picture, layout);
  Layers layers;
  EXPECT_EQ(bars_share(picture, layers, 640, 480, 1), 0);
  layers[Layer::heat].visible = layers[Layer::slice].visible = true;
  picture.bars = {{Layer::heat, "heat", 1}, {Layer::slice, "slice", 1}};
  for (const auto& [width, height, ratio] : {std::tuple(640, 480, 1.0), {1280, 800, 2.0}, {300, 400, 1.0}}) {
    Viewpoint viewpoint = test::front_viewpoint();
    look(viewpoint, StandardView::iso);
    viewpoint.covered_below = bars_share(picture, layers, width, height, ratio);
    fit(viewpoint, extent(picture, Extent::all), static_cast<double>(width) / height);
    const auto view = projection(viewpoint, width, height);
    double lowest = 0;
    for (const TransducerMark& transducer : picture.transducers)
      lowest = std::max(lowest, project(view, Vec3(transducer.position)).y);
    std::vector<shader::ViewStroke> strokes;
    drawing::Ink ink(ratio, theme_of(false).background, strokes);
    draw_bars(ink, picture, layers, width, height, 0, theme_of(false));
    ASSERT_FALSE(strokes.empty());
    double highest = height;
    for (const shader::ViewStroke& stroke : strokes)
      highest = std::min<double>({highest, stroke.from.y, stroke.to.y});
    EXPECT_LT(lowest, highest) << width;
  }
}

TEST(Picture, SaysWhyNothingTouches) {
  Picture picture;
  EXPECT_EQ(why_untouched(picture, "it is far"), "it is far");
  picture.contacts.resize(3);
  EXPECT_EQ(why_untouched(picture, "it is far"), "3 contacts, too few or too far apart for a finger");
  picture.fingers.resize(1);
  EXPECT_EQ(why_untouched(picture, "it is far"), "");
  std::vector<shader::ViewStroke> touched, untouched;
  build_overlay(picture, {}, test::front_viewpoint(), {640, 480, 1, false}, touched);
  picture.untouched = "it is far";
  build_overlay(picture, {}, test::front_viewpoint(), {640, 480, 1, false}, untouched);
  EXPECT_GT(untouched.size(), touched.size()) << "the legend has the line";
}

/// A wall at 0.4 m that fills the left half of an image, and a pixel on its own between it and what lies behind.
TEST(Flying, PixelsBesideARimAreNoSkin) {
  const sensing::Camera camera = test::pinhole("front", 32, 24, 40);
  sensing::DepthFrame frame;
  frame.depth.assign(32 * 24, 0);
  std::vector<sensing::SkinPoint> points, flying;
  const auto put = [&](std::uint32_t u, std::uint32_t v, std::uint16_t raw) {
    frame.depth[v * 32 + u] = raw;
    points.push_back({{}, v * 32 + u});
  };
  for (std::uint32_t v = 0; v < 24; ++v) {
    for (std::uint32_t u = 0; u < 16; ++u)
      put(u, v, 400);
    if (v == 12) put(17, v, 450);
  }
  const std::size_t before = points.size();
  const sensing::RayTables rays = sensing::make_rays({&camera, 1});
  const std::vector<touch::SightCamera> cameras = touch::sight_cameras({&camera, 1}, rays);
  touch::part_flying({cameras, rays, {&frame, 1}}, points, flying);
  ASSERT_EQ(flying.size(), 1u);
  EXPECT_EQ(flying[0].index, 12u * 32 + 17);
  EXPECT_EQ(points.size(), before - 1);
}

}  // namespace
}  // namespace palpa::viewer
