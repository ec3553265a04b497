// What a live run's picture shows of the touch: its close-up, a frame that is kept until its sound is computed, and why
// nothing touches.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <glm/geometric.hpp>

#include "geometry/files/ply.hpp"
#include "geometry/mesh/icosphere.hpp"
#include "live_app.hpp"
#include "support/thrown.hpp"
#include "viewer/picture/field_marks.hpp"

namespace palpa::viewer {
namespace {

TEST_F(LiveApp, ASmallTouchHasACloseUpByItself) {
  const auto views = [&] { return app_->render(size_, 1, now_s_).views; };
  // In every round until a finger touches, and in the first with a touch.
  ASSERT_TRUE(goes_round_until([&] {
    const bool touches = !app_->picture().fingers.empty();
    EXPECT_EQ(views().size(), touches ? 2u : 1u);
    return touches;
  }));
  const View close = views()[1];
  EXPECT_TRUE(close.inset);
  const auto span = [&](const View& view) {
    const auto projected = projection(view.viewpoint, view.area.extent.width, view.area.extent.height);
    Box box;
    for (const FocusMark& focus : app_->picture().fingers[0].foci) {
      const Projected p = project(projected, Vec3(focus.position));
      box.add(Vec3(p.x, p.y, 0));
    }
    return (box.high.x - box.low.x) / view.area.extent.width;
  };
  EXPECT_GT(span(close), 0.2) << "the foci are large in it";
  EXPECT_LT(span(views()[0]), 0.1);
  app_->leave_room_for_close_up(size_);
  const auto seen = projection(views()[0].viewpoint, size_.width, size_.height);
  for (const TransducerMark& transducer : app_->picture().transducers)
    EXPECT_LT(project(seen, Vec3(transducer.position)).x, close.area.offset.x) << "it covers nothing of the array";
  ASSERT_TRUE(app_->data().state.time.playing);
  app_->hold();
  EXPECT_FALSE(app_->data().state.time.playing);
  key('t');
  go_round();
  EXPECT_EQ(views().size(), 1u) << "the touch fills the picture";
}

TEST_F(LiveApp, AFrameIsKeptUntilItsSoundIsComputed) {
  const std::string ball = (folder_ / "ball.ply").string();
  geometry::Mesh mesh = geometry::icosphere(6e-3, 5);
  for (Vec3& p : mesh.positions)
    p.y += 6e-3;
  geometry::write_ply(ball, mesh.positions, mesh.triangles);
  hands_ = false;
  begin("synthetic:" + ball, {.shown = "heat,slice"});
  ASSERT_TRUE(goes_round_until([&] { return !app_->picture().fingers.empty(); }));
  app_->hold();
  const auto contacts = [&] {
    std::vector<glm::vec3> places;
    for (const ContactMark& contact : app_->picture().contacts)
      places.push_back(contact.position);
    return places;
  };
  const std::vector<glm::vec3> kept = contacts();
  go_round();
  ASSERT_TRUE(app_->computes());
  app_->session()->all_off();
  ASSERT_TRUE(goes_round_until([&] { return !app_->computes(); }));
  EXPECT_EQ(state(), LiveState::ended) << "no array sounds for a picture";
  EXPECT_EQ(contacts(), kept);
  const Picture& picture = app_->picture();
  ASSERT_EQ(picture.bars.size(), 2u);
  for (const ColourBar& bar : picture.bars) {
    EXPECT_EQ(bar.standing, Standing::fresh) << bar.title;
    EXPECT_GT(bar.most, 0) << bar.title;
  }
  EXPECT_TRUE(picture.skin && !picture.skin->colours.empty());
  EXPECT_TRUE(std::ranges::count(picture.images, Layer::slice, &ImageMark::layer));
  EXPECT_FALSE(app_->data().state.slice_handles) << "nobody is there to take them";
}

TEST_F(LiveApp, SkinPointsAreThoseNearTheObjectsInASingleTouchToo) {
  make(options_of({{"--scene", {scene_}},
                   {"--depth", {test::source_file("assets/depth/hand.png")}},
                   {"--camera", {test::source_file("assets/depth/camera.toml")}},
                   {"--backend", {"cpu"}}}));
  const Picture& picture = app_->picture();
  EXPECT_GT(picture.contacts.size(), 50u);
  EXPECT_EQ(picture.skin_count, picture.skin_points.size() + picture.contacts.size()) << "and not all of the room";
}

TEST_F(LiveApp, APictureSaysHowFarTheSkinIsFromTheObject) {
  begin("mouse");
  ASSERT_TRUE(comes_to(LiveState::running));
  // From the front, the pointer puts the tip 25 mm above the top of the cube.
  key('1');
  go_round();
  const Box cube = geometry::bounds(app_->picture().solids.at(0).mesh);
  const Projected above = pixel_of({0, cube.high.y + 25e-3, app_->data().state.viewpoint.target.z});
  button(Kind::move, above.x - 1, above.y);
  button(Kind::move, above.x, above.y);
  const std::string before = "the nearest skin is ", after = " mm away from the surface of cube";
  const auto told = [&] {
    const std::string& text = app_->picture().untouched;
    return text.starts_with(before) && text.ends_with(after) ? std::atof(text.c_str() + before.size()) : 0;
  };
  const auto real = [&] { return 1e3 * (app_->data().placing->finger()[3].y - cube.high.y); };
  ASSERT_TRUE(goes_round_until([&] { return told() > 0 && std::abs(told() - real()) < 3; }))
      << app_->picture().untouched << ", " << real();
  EXPECT_NEAR(real(), 25, 15);
}

}  // namespace
}  // namespace palpa::viewer
