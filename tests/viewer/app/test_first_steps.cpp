// What people do with the window alone, from an empty one.
#include <gtest/gtest.h>

#include <chrono>
#include <fstream>

#include "live_app.hpp"
#include "support/files.hpp"
#include "support/thrown.hpp"
#include "viewer/app/own_files.hpp"
#include "viewer/live/live_line.hpp"
#include "viewer/panels/panels.hpp"
#include "viewer/panels/stroke_font.hpp"

namespace palpa::viewer {
namespace {

class FirstSteps : public LiveAppWithPanels {
 protected:
  FirstSteps() : LiveAppWithPanels({1000, 1600}) {}

  void begin_empty() {
    ViewerOptions options;
    options.given = {{"--backend", {"cpu"}},
                     {"--layout", {"autd3"}},
                     {"--link", {"heard"}},
                     {"--hold", {"5s"}},
                     {"--noise-free", {}}};
    now_s_ = 0;
    make(options);
    draw();
  }
  void begin_touch() {
    ViewerOptions options = options_of({{"--scene", {scene_}},
                                        {"--points", {test::source_file("assets/finger.ply")}},
                                        {"--penetration", {"3mm"}},
                                        {"--backend", {"cpu"}}});
    make(options);
    draw();
  }
  Size beside_panels() const {
    return {static_cast<std::uint32_t>(size_.width - panels_width(size_.width, text_height)),
            static_cast<std::uint32_t>(size_.height - strip_height(text_height))};
  }
  bool opened() {
    return goes_round_until([&] { return !app_->data().content.opening; });
  }
};

TEST_F(FirstSteps, AnEmptyWindowOffersTheObjects) {
  begin_empty();
  ASSERT_TRUE(app_->data().content.empty);
  for (const char* object : {"cube", "pyramid", "prism", "semi-sphere"})
    EXPECT_TRUE(place_of_widget(object)) << object;
  click("cube");
  ASSERT_TRUE(comes_to(LiveState::running));
  EXPECT_EQ(went_live_, 1);
  EXPECT_EQ(options().source, "mouse");
  ASSERT_TRUE(goes_round_until([&] { return app_->showed_frame(); }));
  EXPECT_FALSE(app_->data().content.empty);
  EXPECT_TRUE(has_said("holds a fingertip"));
  EXPECT_LT(app_->data().state.viewpoint.distance, 0.45) << "the cube is seen from near, although the array is large";
  key('f');
  EXPECT_GT(app_->data().state.viewpoint.distance, 0.5) << "F shows everything";
  EXPECT_EQ(app_->title(), "cube.glb, live (mouse)");
  EXPECT_EQ(app_->data().content.recent.size(), 1u);
}

TEST_F(FirstSteps, AFileIsOpenedByItsName) {
  begin_empty();
  click("open a file");
  ASSERT_TRUE(app_->data().picker);
  click("name");
  type(folder_.string());
  ASSERT_TRUE(app_->data().picker) << "it is a folder";
  EXPECT_EQ(app_->data().picker->folder, folder_.string());
  EXPECT_TRUE(place_of_widget("file cube.glb"));
  click("name");
  type("cube.glb");
  EXPECT_FALSE(app_->data().picker);
  ASSERT_TRUE(comes_to(LiveState::running));
  EXPECT_EQ(fs::path(options().scene).filename(), "cube.glb");
  click("open");
  click("opened before");
  ASSERT_TRUE(app_->data().places.list);
}

/// The first move onto a panel comes before the panels know of the pointer.
TEST_F(FirstSteps, AFingerStaysWhileThePointerIsOverAPanel) {
  begin_empty();
  click("cube");
  ASSERT_TRUE(comes_to(LiveState::running));
  ASSERT_TRUE(goes_round_until([&] { return app_->showed_frame(); }));
  button(WindowEvent::Kind::move, 300, 700);
  button(WindowEvent::Kind::move, 310, 700);
  draw();
  ASSERT_TRUE(app_->data().placing->holds_finger());
  const Transform before = app_->data().placing->finger();
  button(WindowEvent::Kind::move, 900, 300);
  draw();
  EXPECT_EQ(app_->data().placing->finger(), before);
}

TEST_F(FirstSteps, APlyIsWhatTouches) {
  begin_empty();
  const std::string finger = test::source_file("assets/finger.ply");
  drop(finger);
  draw();
  EXPECT_TRUE(says("touches the object that you open next"));
  drop(scene_);
  ASSERT_TRUE(comes_to(LiveState::running));
  EXPECT_EQ(options().source, "mouse:" + finger);
}

TEST_F(FirstSteps, ARecordingWaitsForItsObject) {
  begin_empty();
  drop(recording());
  ASSERT_TRUE(goes_round_until([&] { return says("the object that you open next"); }));
  EXPECT_TRUE(app_->data().content.empty);
  EXPECT_EQ(went_live_, 0);
  click("cube");
  ASSERT_TRUE(comes_to(LiveState::running));
  EXPECT_EQ(options().source, "recording:" + recording().string());
  EXPECT_TRUE(goes_round_until([&] { return app_->data().content.run.playback.has_value(); }));
}

TEST_F(FirstSteps, AnotherObjectIsFramed) {
  begin("synthetic");
  ASSERT_TRUE(goes_round_until([&] { return app_->showed_frame(); }));
  const double before = app_->data().state.viewpoint.distance;
  for (int i = 0; i < 10; ++i) {
    WindowEvent event;
    event.kind = WindowEvent::Kind::scroll;
    event.x = 300, event.y = 300;
    event.steps = 1;
    app_->handle(event, size_);
  }
  draw();
  ASSERT_LT(app_->data().state.viewpoint.distance, 0.5 * before);
  key(Key::page_down);
  ASSERT_TRUE(opens_other());
  ASSERT_TRUE(goes_round_until([&] { return app_->data().state.viewpoint.distance > 0.8 * before; }));
}

TEST_F(FirstSteps, FingersAndHandsAreNoObjects) {
  const auto scenes = scenes_beside(test::source_file("assets/cube.glb"));
  EXPECT_GE(scenes.size(), 4u);
  for (const std::string& scene : scenes) {
    const std::string name = fs::path(scene).filename();
    EXPECT_FALSE(name.starts_with("hand") || name.starts_with("finger")) << name;
  }
}

TEST_F(FirstSteps, ATouchHasTheSameOptionsAndIsFoundAgainWithThem) {
  begin_touch();
  ASSERT_EQ(app_->picture().fingers.size(), 1u);
  const std::size_t before = app_->picture().fingers[0].foci.size();
  click("Run");
  click("Touch");
  click("--foci");
  type("7");
  ASSERT_TRUE(opened());
  draw();
  EXPECT_EQ(before, 10u);
  ASSERT_EQ(app_->picture().fingers.size(), 1u);
  EXPECT_EQ(app_->picture().fingers[0].foci.size(), 7u);
  click("--foci reset");
  ASSERT_TRUE(opened());
  draw();
  EXPECT_EQ(app_->picture().fingers[0].foci.size(), 10u);
  EXPECT_FALSE(place_of_widget("--foci reset")) << "the default has nothing to reset";
}

TEST_F(FirstSteps, AnErrorGoesWhenItsCauseIsMended) {
  begin_touch();
  click("Run");
  click("Touch");
  click("--foci");
  type("nonsense");
  EXPECT_TRUE(says("--foci"));
  click("--foci");
  type("9");
  EXPECT_FALSE(says("nonsense"));
}

/// A plane that a person has chosen stays chosen when options change and when files are opened.
TEST_F(FirstSteps, AChosenPlaneOfTheFieldStays) {
  make(options_of({{"--scene", {scene_}},
                   {"--points", {test::source_file("assets/finger.ply")}},
                   {"--penetration", {"3mm"}},
                   {"--layout", {"autd3"}},
                   {"--slice", {"xz"}},
                   {"--slice-at", {"0,0.01,0"}},
                   {"--slice-size", {"30mm"}},
                   {"--backend", {"cpu"}}}));
  draw();
  click("Sound");
  const auto chosen = [&](const std::string& plane) {
    const Transform& T = app_->data().state.slice.T_world_slice;
    const auto letters = [&](std::size_t axis) { return T[static_cast<int>(axis)][plane[axis] - 'x'] == 1; };
    key('c');
    draw(1);
    return letters(0) && letters(1) && copied_.find("--slice " + plane + " ") != std::string::npos &&
           copied_.find("--slice-size 0.03") != std::string::npos;
  };
  EXPECT_TRUE(chosen("xz")) << copied_;
  click("plane yz");
  EXPECT_TRUE(chosen("yz")) << copied_;
  const Transform placed = app_->data().state.slice.T_world_slice;
  EXPECT_GT(std::abs(placed[3].y - 0.01), 1e-3) << "through the middle of the touch";
  click("Run");
  click("Touch");
  click("--foci");
  type("7");
  ASSERT_TRUE(opened());
  draw();
  ASSERT_EQ(app_->picture().fingers.at(0).foci.size(), 7u);
  EXPECT_TRUE(chosen("yz")) << "after an option: " << copied_;
  drop(test::source_file("assets/finger.ply"));
  ASSERT_TRUE(opened());
  EXPECT_TRUE(chosen("yz")) << "after a PLY: " << copied_;
  drop(other_);
  ASSERT_TRUE(opened());
  EXPECT_TRUE(chosen("yz")) << "after an object: " << copied_;
  EXPECT_EQ(app_->data().state.slice.T_world_slice, placed);
  click("--foci");
  type("0");
  EXPECT_TRUE(chosen("yz")) << "after a refusal: " << copied_;
}

TEST_F(FirstSteps, KeysWithoutAnEffectSaySo) {
  begin_touch();
  key('g');
  EXPECT_TRUE(says("G: this is one touch"));
  key('r');
  EXPECT_TRUE(says("R: no run is under way"));
  key(Key::left);
  EXPECT_TRUE(says("no recording is played"));
  key('c');
  draw();
  EXPECT_CONTAINS(copied_, "palpa-viewer --scene");
  EXPECT_CONTAINS(copied_, "--eye ");
}

TEST_F(FirstSteps, TheParticipantsWindowTakesPAndQ) {
  begin_touch();
  app_->tell_monitors({"one 1920x1080"});
  app_->try_participant(true);
  draw();
  EXPECT_TRUE(app_->data().participant.says_how_to_leave) << "there is one monitor";
  now_s_ += 20;
  draw();
  EXPECT_FALSE(app_->data().participant.says_how_to_leave);
  WindowEvent event;
  event.kind = WindowEvent::Kind::key;
  event.key = key_of('p');
  app_->handle_participant(event);
  draw();
  EXPECT_FALSE(app_->data().participant.open);
  app_->try_participant(true);
  app_->participant().fills({1000, 1000});
  EXPECT_TRUE(says("stretched"));
  event.key = key_of('q');
  app_->handle_participant(event);
  EXPECT_TRUE(app_->quitting());
}

/// Touches an object; changes the method; records, pauses, steps; moves the object and saves it; silences, starts
/// again.
TEST_F(FirstSteps, FiveTasksWithNothingButTheWindow) {
  const fs::path before = fs::current_path();
  fs::current_path(folder_);
  begin_empty();
  click("cube");
  ASSERT_TRUE(comes_to(LiveState::running));
  ASSERT_TRUE(goes_round_until([&] { return app_->showed_frame(); }));
  EXPECT_FALSE(app_->data().placing->can_undo());
  const auto touch = [&] {
    return goes_round_until([&] {
      const Vec3 at(0, -0.002, 0);
      const Projected p =
          project(projection(app_->data().state.viewpoint, beside_panels().width, beside_panels().height), at);
      button(WindowEvent::Kind::move, p.x, p.y + 37);
      draw(1);
      return heard_->last_sounds.load();
    });
  };
  ASSERT_TRUE(touch()) << "1: touch the object";

  click("Run");
  click("Touch");
  click("--method");
  ASSERT_TRUE(app_->data().places.list);
  const Area field = *place_of_widget("--method");
  click_at(field.left + 20, field.bottom + 3 * (field.bottom - field.top) / 2 + 4);
  EXPECT_NE(options().touch.method.method, touch::Method::cross_section) << "2: change the method";
  ASSERT_TRUE(comes_to(LiveState::running));
  click("Touch");
  click("Run");
  ASSERT_TRUE(touch()) << "and go on touching";

  // The new method may begin another run only now, which ends a recording of the run before. A busy machine takes a
  // while to begin a recording, and another click would end it.
  fs::path recording;
  auto clicked = std::chrono::steady_clock::time_point::min();
  ASSERT_TRUE(goes_round_until([&] {
    const auto now = std::chrono::steady_clock::now();
    if (app_->data().content.run.recording.empty() &&
        (clicked == clicked.min() || now - clicked > std::chrono::seconds(10))) {
      click("record");
      clicked = now;
    }
    recording = app_->data().content.run.recording;
    return !recording.empty() && app_->data().content.run.recorded > 5;
  })) << "3: record";
  click("record");
  ASSERT_TRUE(goes_round_until([&] { return app_->data().content.run.recording.empty(); }));
  EXPECT_TRUE(app_->data().content.recent.front().ends_with(recording.string()));
  click("play made");
  ASSERT_TRUE(goes_round_until([&] { return app_->data().content.run.playback.has_value(); }));
  click("recording play");
  ASSERT_TRUE(goes_round_until([&] { return !app_->data().content.run.playback->playing; })) << "pause";
  const std::uint64_t frame = app_->data().content.run.playback->frame;
  click("recording step");
  EXPECT_TRUE(goes_round_until([&] { return app_->data().content.run.playback->frame != frame; })) << "step";
  EXPECT_FALSE(place_of_widget("play made")) << "it is being played";

  key('g');
  draw();
  ASSERT_TRUE(app_->data().placing->chosen()) << "4: move the object";
  ASSERT_TRUE(goes_round_until([&] { return !app_->data().marks.empty(); }));
  const Size size = beside_panels();
  const Sight sight{app_->data().state.viewpoint, static_cast<double>(size.width), static_cast<double>(size.height), 1};
  // The middle of the cube. The picture's extent may also have the finger of the frame.
  const Gizmo gizmo = gizmo_at(Vec3(0, -0.02, 0), sight);
  const Projected tip =
      project(projection(sight.viewpoint, sight.width, sight.height), gizmo.at + Vec3(0, 0.8 * gizmo.size_m, 0));
  button(WindowEvent::Kind::move, tip.x, tip.y + 37);
  draw();
  button(WindowEvent::Kind::press, tip.x, tip.y + 37);
  button(WindowEvent::Kind::move, tip.x, tip.y + 20);
  draw();
  button(WindowEvent::Kind::release, tip.x, tip.y + 20);
  draw();
  EXPECT_TRUE(app_->data().placing->can_undo());
  ASSERT_TRUE(app_->data().placing->moved());
  click("save as");
  EXPECT_TRUE(goes_round_until([&] { return options().scene == "moved.glb"; })) << "and save it";
  EXPECT_TRUE(app_->data().content.recent.front().ends_with("/moved.glb"));
  ASSERT_TRUE(comes_to(LiveState::running));
  click("close recording");
  ASSERT_TRUE(goes_round_until([&] { return !app_->data().content.run.playback; }));
  EXPECT_EQ(options().source, "mouse");
  ASSERT_TRUE(comes_to(LiveState::running));

  const Area off = all_off_button();
  button(WindowEvent::Kind::press, off.left + 3, off.top + 3);
  button(WindowEvent::Kind::release, off.left + 3, off.top + 3);
  ASSERT_TRUE(comes_to(LiveState::ended)) << "5: silence it";
  EXPECT_FALSE(heard_->last_sounds);
  draw();
  click(app_->data().places.start.value_or(Area()));
  EXPECT_TRUE(comes_to(LiveState::running)) << "and start again";
  app_.reset();
  fs::current_path(before);
}

}  // namespace
}  // namespace palpa::viewer
