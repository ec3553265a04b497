// What people do with the window alone, from an empty one.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>

#include "live_app.hpp"
#include "viewer/app/own_files.hpp"
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
  /// Begins a run by a click on the cube.
  void open_cube() {
    click("cube");
    ASSERT_TRUE(comes_to(LiveState::running));
    ASSERT_TRUE(shows_frame());
  }
  /// The foci of the first finger, once the touch has been found again.
  std::size_t foci() {
    EXPECT_TRUE(opened());
    draw();
    return app_->picture().fingers.empty() ? 0 : app_->picture().fingers[0].foci.size();
  }
  void unfold_touch() {
    click("Run");
    click("Touch");
  }
  bool opened() {
    return goes_round_until([&] { return !app_->data().content.opening; });
  }
};

TEST_F(FirstSteps, AnEmptyWindowOffersTheObjects) {
  begin_empty();
  ASSERT_TRUE(app_->data().content.empty);
  EXPECT_EQ(app_->title(), "");
  ASSERT_EQ(app_->picture().fingers.size(), 1u) << "a finger on the cube plays meanwhile";
  const auto running = app_->picture().fingers[0].running;
  EXPECT_TRUE(goes_round_until([&] { return app_->picture().fingers[0].running != running; }));
  EXPECT_FALSE(app_->data().content.can_start) << "it is no touch of the user's";
  for (const char* object : {"cube", "pyramid", "prism", "semi-sphere"})
    EXPECT_TRUE(place_of_widget(object)) << object;
  open_cube();
  EXPECT_EQ(went_live_, 1);
  EXPECT_EQ(options().source, "mouse");
  EXPECT_FALSE(app_->data().content.empty);
  EXPECT_FALSE(app_->picture().skin);
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
  type("name", folder_.string());
  ASSERT_TRUE(app_->data().picker) << "it is a folder";
  EXPECT_EQ(app_->data().picker->folder, folder_.string());
  EXPECT_TRUE(place_of_widget("file cube.glb"));
  type("name", "cube.glb");
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
  open_cube();
  for (const bool after_a_drag : {false, true}) {
    button(Kind::move, 300, 700);
    if (after_a_drag) button(Kind::press, 300, 700);
    button(Kind::move, 310, 700);
    if (after_a_drag) button(Kind::release, 310, 700);
    draw();
    ASSERT_TRUE(app_->data().placing->holds_finger());
    const Transform before = app_->data().placing->finger();
    button(Kind::move, 900, 300);
    draw();
    EXPECT_EQ(app_->data().placing->finger(), before) << after_a_drag;
  }
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
  ASSERT_TRUE(comes_to_say("the object that you open next"));
  EXPECT_TRUE(app_->data().content.empty);
  EXPECT_EQ(went_live_, 0);
  click("cube");
  ASSERT_TRUE(comes_to(LiveState::running));
  EXPECT_EQ(options().source, "recording:" + recording().string());
  EXPECT_TRUE(goes_round_until([&] { return app_->data().content.run.playback.has_value(); }));
}

TEST_F(FirstSteps, AnotherObjectIsFramedAndAfterTheLastComesTheFirst) {
  ASSERT_TRUE(shows_frame());
  const double before = app_->data().state.viewpoint.distance;
  for (int i = 0; i < 10; ++i)
    send({.kind = Kind::scroll, .x = 300, .y = 300, .steps = 1});
  draw();
  ASSERT_LT(app_->data().state.viewpoint.distance, 0.5 * before);
  key(Key::page_up);
  ASSERT_TRUE(opens_other()) << "the last of the folder";
  ASSERT_TRUE(goes_round_until([&] { return app_->data().state.viewpoint.distance > 0.8 * before; }));
  const int runs = heard_->opened;
  key(Key::page_down);
  ASSERT_TRUE(goes_round_until([&] { return heard_->opened > runs; }));
  EXPECT_EQ(options().scene, scene_) << "the first";
}

TEST(Neighbours, AreObjectsAndNoFingersOrHands) {
  const auto scenes = scenes_beside(test::source_file("assets/cube.glb"));
  EXPECT_GE(scenes.size(), 4u);
  for (const std::string& scene : scenes) {
    const std::string name = fs::path(scene).filename();
    EXPECT_FALSE(name.starts_with("hand") || name.starts_with("finger")) << name;
  }
}

TEST_F(FirstSteps, ATouchHasTheSameOptionsAndIsFoundAgainWithThem) {
  make_touch();
  EXPECT_EQ(foci(), 10u);
  unfold_touch();
  type("--foci", "nonsense");
  EXPECT_TRUE(says("--foci"));
  type("--foci", "7");
  EXPECT_FALSE(says("nonsense")) << "the error is gone with its cause";
  EXPECT_EQ(foci(), 7u);
  click("--foci reset");
  EXPECT_EQ(foci(), 10u);
  EXPECT_FALSE(place_of_widget("--foci reset")) << "the default has nothing to reset";
}

/// A plane that a person has chosen stays chosen when options change and when files are opened.
TEST_F(FirstSteps, AChosenPlaneOfTheFieldStays) {
  make_touch({{"--layout", {"autd3"}}, {"--slice", {"xz"}}, {"--slice-at", {"0,0.01,0"}}, {"--slice-size", {"30mm"}}});
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
  unfold_touch();
  type("--foci", "7");
  EXPECT_EQ(foci(), 7u);
  EXPECT_TRUE(chosen("yz")) << "after an option: " << copied_;
  for (const fs::path& file : {test::source_file("assets/finger.ply"), other_}) {
    drop(file);
    ASSERT_TRUE(opened());
    EXPECT_TRUE(chosen("yz")) << file << ": " << copied_;
  }
  EXPECT_EQ(app_->data().state.slice.T_world_slice, placed);
  type("--foci", "0");
  EXPECT_TRUE(chosen("yz")) << "after a refusal: " << copied_;
}

TEST_F(FirstSteps, TheCopiedLineOfAnUntouchedViewHasNoLayers) {
  make_touch();
  draw();
  key('c');
  draw();
  EXPECT_TRUE(copied_.starts_with("palpa-viewer ")) << copied_;
  for (const char* option : {"--opacity", "--show", "--hide", "--explode", "--heat", "--dark", "--slice"})
    EXPECT_EQ(copied_.find(option), std::string::npos) << copied_;
}

TEST_F(FirstSteps, KeysWithoutAnEffectSaySo) {
  make_touch();
  draw();
  for (const auto& [pressed, told] : {std::pair(key_of('g'), "G: this is one touch"),
                                      {key_of('r'), "R: no run is under way"},
                                      {Key::left, "no recording is played"}}) {
    key(pressed);
    EXPECT_TRUE(says(told)) << told;
  }
}

TEST_F(FirstSteps, TheParticipantsWindowTakesPAndQ) {
  make_touch();
  app_->tell_monitors({"one 1920x1080"});
  app_->try_participant(true);
  draw();
  EXPECT_TRUE(app_->data().participant.says_how_to_leave) << "there is one monitor";
  now_s_ += 20;
  draw();
  EXPECT_FALSE(app_->data().participant.says_how_to_leave);
  app_->handle_participant({.kind = Kind::key, .key = key_of('p')});
  draw();
  EXPECT_FALSE(app_->data().participant.open);
  app_->try_participant(true);
  app_->participant().fills({1000, 1000});
  EXPECT_TRUE(says("stretched"));
  app_->handle_participant({.kind = Kind::key, .key = Key::escape});
  draw();
  EXPECT_FALSE(app_->data().participant.open);
  app_->handle_participant({.kind = Kind::key, .key = key_of('q')});
  EXPECT_TRUE(app_->quitting());
}

/// Touches an object; changes the method; records, pauses, steps; moves the object and saves it.
TEST_F(FirstSteps, FourTasksWithNothingButTheWindow) {
  const fs::path before = fs::current_path();
  fs::current_path(folder_);
  begin_empty();
  open_cube();
  const auto& run = app_->data().content.run;
  const Placing& placing = *app_->data().placing;
  EXPECT_FALSE(placing.can_undo());
  const auto sight = [&] {
    const auto width = static_cast<double>(size_.width), height = static_cast<double>(size_.height);
    return Sight{app_->data().state.viewpoint, std::floor(width - panels_width(width, text_height)),
                 height - strip_height(text_height), 1};
  };
  const auto pixel = [&](const Vec3& at) {
    const Projected p = project(projection(sight().viewpoint, sight().width, sight().height), at);
    return Vec2(p.x, p.y + strip_height(text_height));
  };
  const auto touch = [&] {
    return goes_round_until([&] {
      const Vec2 at = pixel({0, -0.002, 0});
      button(Kind::move, at.x, at.y);
      draw(1);
      return heard_->last_sounds.load();
    });
  };
  ASSERT_TRUE(touch()) << "1: touch the object";

  unfold_touch();
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
    if (run.recording.empty() && (clicked == clicked.min() || now - clicked > std::chrono::seconds(10))) {
      click("record");
      clicked = now;
    }
    recording = run.recording;
    return !recording.empty() && run.recorded > 5;
  })) << "3: record";
  click("record");
  ASSERT_TRUE(goes_round_until([&] { return run.recording.empty(); }));
  EXPECT_TRUE(app_->data().content.recent.front().ends_with(recording.string()));
  click("play made");
  // A line above the buttons goes when it plays, and another may come and go meanwhile: the buttons move.
  ASSERT_TRUE(goes_round_until([&] {
    return run.playback && !place_of_widget("play made") && state() == LiveState::running &&
           app_->data().content.doing.empty();
  })) << "play";
  click("recording play");
  ASSERT_TRUE(goes_round_until([&] { return !run.playback->playing; })) << "pause";
  const std::uint64_t frame = run.playback->frame;
  click(frame + 1 < run.playback->frames ? "recording step" : "recording back");  // no frame follows the last one
  EXPECT_TRUE(goes_round_until([&] { return run.playback->frame != frame; })) << "step";

  key('g');
  draw();
  ASSERT_TRUE(placing.chosen()) << "4: move the object";
  ASSERT_TRUE(goes_round_until([&] { return !app_->data().marks.empty(); }));
  // The middle of the cube. The picture's extent may also have the finger of the frame.
  const Gizmo gizmo = gizmo_at(Vec3(0, -0.02, 0), sight());
  const Vec2 tip = pixel(gizmo.at + Vec3(0, 0.8 * gizmo.size_m, 0));
  button(Kind::move, tip.x, tip.y);
  draw();
  button(Kind::press, tip.x, tip.y);
  button(Kind::move, tip.x, tip.y - 17);
  draw();
  button(Kind::release, tip.x, tip.y - 17);
  draw();
  EXPECT_TRUE(placing.can_undo());
  ASSERT_TRUE(placing.moved());
  click("save as");
  EXPECT_TRUE(goes_round_until([&] { return options().scene == "moved.glb"; })) << "and save it";
  EXPECT_TRUE(app_->data().content.recent.front().ends_with("/moved.glb"));
  ASSERT_TRUE(comes_to(LiveState::running));
  click("close recording");
  ASSERT_TRUE(goes_round_until([&] { return !run.playback; }));
  EXPECT_EQ(options().source, "mouse");
  app_.reset();
  fs::current_path(before);
}

}  // namespace
}  // namespace palpa::viewer
