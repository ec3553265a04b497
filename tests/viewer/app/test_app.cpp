// The viewer without its window: a live run starts, ends and restarts in it.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "base/outputs.hpp"
#include "geometry/files/ply.hpp"
#include "geometry/mesh/icosphere.hpp"
#include "live_app.hpp"
#include "support/files.hpp"
#include "support/thrown.hpp"
#include "viewer/picture/field_marks.hpp"

namespace palpa::viewer {
namespace {

TEST_F(LiveApp, AllOffLastsWhateverChanges) {
  ASSERT_TRUE(goes_round_until([&] { return heard_->sounded(); }));
  all_off();
  ASSERT_TRUE(comes_to(LiveState::ended));
  EXPECT_TRUE(stays_off());
  EXPECT_FALSE(heard_->last_sounds);
  write_again(scene_);
  EXPECT_TRUE(stays_off()) << "the scene was written again";
  drop(other_);
  EXPECT_TRUE(stays_off()) << "another scene";
  EXPECT_TRUE(opens_other()) << "is what Start begins";
}

TEST_F(LiveApp, AllOffWinsOverARestart) {
  ASSERT_TRUE(comes_to(LiveState::running));
  drop(other_);
  ASSERT_TRUE(opens_other());  // the restart is pending: the old run has not ended yet, or the new one has just begun
  all_off();
  ASSERT_TRUE(comes_to(LiveState::ended));
  EXPECT_TRUE(stays_off());
}

TEST_F(LiveApp, AllOffWinsOverWhatIsAskedForWithIt) {
  ASSERT_TRUE(comes_to(LiveState::running));
  drop(other_);
  all_off();
  ASSERT_TRUE(comes_to(LiveState::ended));
  EXPECT_TRUE(stays_off());
}

TEST_F(LiveApp, ASceneThatIsWrittenAgainRestartsAndKeepsItsOptions) {
  ASSERT_TRUE(comes_to(LiveState::running));
  go_round(11);
  write_again(scene_);
  ASSERT_TRUE(comes_to(LiveState::loading));
  ASSERT_TRUE(comes_to(LiveState::running));
  EXPECT_TRUE(options().gltf_scene);
}

TEST_F(LiveApp, ASceneThatIsWrittenAgainStartsNoRunThatIsOver) {
  ASSERT_TRUE(comes_to(LiveState::running));
  heard_->breaks = true;
  ASSERT_TRUE(comes_to(LiveState::failed));
  heard_->breaks = false;
  const int runs = heard_->opened;
  go_round(11);
  write_again(scene_);
  go_round(50);
  EXPECT_EQ(app_->data().content.run.state, LiveState::failed);
  EXPECT_EQ(heard_->opened, runs) << "nobody chose Start";
  EXPECT_TRUE(
      app_->data().messages.log().back().text.ends_with("cube.glb: was written again; Start begins a run with it"));
}

TEST_F(LiveApp, ASceneThatIsRepairedBeginsTheRunThatFailedOnIt) {
  const std::string whole = test::read_text(scene_);
  std::ofstream(scene_, std::ios::binary) << whole.substr(0, whole.size() / 2);
  begin("synthetic");
  ASSERT_TRUE(comes_to(LiveState::failed));
  go_round(11);
  std::ofstream(scene_, std::ios::binary) << whole;
  write_again(scene_);
  EXPECT_TRUE(comes_to(LiveState::running));
}

TEST_F(LiveApp, AnotherSceneIsNotOneThatWasWrittenAgain) {
  ASSERT_TRUE(comes_to(LiveState::running));
  go_round(11);
  write_again(other_);
  drop(other_);
  ASSERT_TRUE(opens_other());
  EXPECT_FALSE(options().gltf_scene) << "that was of the one before";
  ASSERT_TRUE(comes_to(LiveState::loading));
  ASSERT_TRUE(comes_to(LiveState::running));
  go_round(50);
  EXPECT_EQ(app_->data().content.run.state, LiveState::running);
}

TEST_F(LiveApp, SavesNoSceneOverAFileThatIsRead) {
  const auto kept = keep_register();
  begin("synthetic:" + test::source_file("assets/finger.ply").string());
  ASSERT_TRUE(comes_to(LiveState::running));
  const std::string before = test::read_text(scene_);
  fs::remove(folder_ / "soft.glb");
  fs::create_symlink(scene_, folder_ / "soft.glb");
  for (const std::string& file : {scene_.string(), (folder_ / "soft.glb").string(),
                                  (folder_ / ".." / folder_.filename() / scene_.filename()).string()}) {
    app_->save_scene(file);
    EXPECT_EQ(test::read_text(scene_), before) << file;
  }
  // It may overwrite its own files, even while it reads them. An hour lies in between, because times are in
  // milliseconds.
  auto last = fs::file_time_type::min();
  for (int i = 0; i < 2; ++i) {
    app_->save_scene(folder_ / "mine.glb");
    ASSERT_TRUE(fs::exists(folder_ / "mine.glb")) << i;
    const fs::file_time_type written = fs::last_write_time(folder_ / "mine.glb");
    EXPECT_TRUE(written > last) << i;
    fs::last_write_time(folder_ / "mine.glb", last = written - 1h);
    EXPECT_TRUE(goes_round_until([&] { return !app_->beginning(); }));
    go_round();  // now it has checked the scene that it has read
  }
}

TEST_F(LiveAppWithPanels, StartBeginsAgainAfterAllOff) {
  ASSERT_TRUE(comes_to(LiveState::running));
  draw();
  all_off();
  ASSERT_TRUE(comes_to(LiveState::ended));
  EXPECT_TRUE(stays_off());
  draw();
  const std::uint64_t before = heard_->sounding;
  const Area off = all_off_button();  // Start is to the right of it
  const double x = off.right + 0.3 * (off.right - off.left), y = (off.top + off.bottom) / 2;
  button(WindowEvent::Kind::move, x, y);
  draw();
  button(WindowEvent::Kind::press, x, y);
  draw(1);
  button(WindowEvent::Kind::release, x, y);
  draw(1);
  ASSERT_TRUE(comes_to(LiveState::running));
  EXPECT_FALSE(stop_);
  EXPECT_TRUE(goes_round_until([&] { return heard_->sounding > before; })) << "it sounds again";
  all_off();
  ASSERT_TRUE(comes_to(LiveState::ended)) << "and can be switched off again";
  EXPECT_FALSE(heard_->last_sounds);
}

/// The run is off, Start is clicked, and the key is pressed before a picture shows this: the last input counts.
TEST_F(LiveAppWithPanels, AllOffWinsOverAStartThatNoPictureHasShown) {
  for (const bool pressed_before : {false, true}) {
    ASSERT_TRUE(comes_to(LiveState::running));
    draw();
    all_off();
    ASSERT_TRUE(comes_to(LiveState::ended));
    draw();
    const Area off = all_off_button();
    const double x = off.right + 0.3 * (off.right - off.left), y = (off.top + off.bottom) / 2;
    button(WindowEvent::Kind::move, x, y);
    draw();
    button(WindowEvent::Kind::press, x, y);
    if (pressed_before) draw(1);
    button(WindowEvent::Kind::release, x, y);
    if (pressed_before) app_->render(size_, 1, now_s_);  // requested, but not done yet
    all_off();
    draw();
    EXPECT_TRUE(stays_off()) << pressed_before;
    EXPECT_FALSE(heard_->last_sounds);
    button(WindowEvent::Kind::press, x, y);
    draw(1);
    button(WindowEvent::Kind::release, x, y);
    draw(1);
  }
  EXPECT_TRUE(comes_to(LiveState::running)) << "a click after it does";
}

TEST_F(LiveAppWithPanels, AllOffWaitsForNoPicture) {
  ASSERT_TRUE(comes_to(LiveState::running));
  draw();
  for (int i = 0; i < 50; ++i) {  // keys that are held down; each change takes a picture
    key('.');
    key('.', false);
  }
  const Area off = all_off_button();
  ASSERT_GT(off.right, off.left);
  button(WindowEvent::Kind::press, off.left + 2, off.top + 2);
  EXPECT_TRUE(stop_) << "before anything was drawn";
  ASSERT_TRUE(comes_to(LiveState::ended));
  button(WindowEvent::Kind::release, off.left + 2, off.top + 2);
  draw();
  EXPECT_TRUE(stays_off());
}

TEST_F(LiveApp, ASwitchThatIsHeldDownIsThrownOnce) {
  WindowEvent event;
  event.kind = WindowEvent::Kind::key;
  event.key = key_of('h');
  app_->handle(event, size_);
  event.repeat = true;
  app_->handle(event, size_);
  EXPECT_TRUE(app_->data().help);
  event.key = key_of('-');
  const double before = app_->data().state.time.slots_per_s;
  app_->handle(event, size_);
  EXPECT_LT(app_->data().state.time.slots_per_s, before) << "slower and slower";
}

TEST_F(LiveApp, CopiesTheCommandOfTheRunThatThereIs) {
  const std::string rest = " --source synthetic --hold 5s --noise-free --link heard --layout autd3 --backend cpu";
  ASSERT_TRUE(comes_to(LiveState::running));
  copy_run();
  go_round();
  EXPECT_EQ(copied_, "palpa run --scene " + scene_.string() + " --gltf-scene 0" + rest);
  drop(other_);
  ASSERT_TRUE(opens_other());
  copy_run();
  go_round();
  EXPECT_EQ(copied_, "palpa run --scene " + other_.string() + rest);
}

TEST_F(LiveApp, ABrokenSceneEndsNothing) {
  ASSERT_TRUE(comes_to(LiveState::running));
  std::ofstream(folder_ / "broken.glb") << "no glTF";
  drop(folder_ / "broken.glb");
  ASSERT_TRUE(goes_round_until([&] { return !app_->data().messages.toasts().empty(); }));
  EXPECT_CONTAINS(app_->data().messages.toasts().back().text, "broken.glb");
  EXPECT_EQ(app_->data().content.run.state, LiveState::running);
  EXPECT_EQ(options().scene, scene_);
}

TEST_F(LiveApp, ABrokenRecordingEndsNothing) {
  ASSERT_TRUE(comes_to(LiveState::running));
  fs::create_directory(folder_ / "broken");
  std::ofstream(folder_ / "broken" / "recording.toml") << "[recording]\n";
  drop(folder_ / "broken");
  ASSERT_TRUE(goes_round_until([&] { return !app_->data().messages.toasts().empty(); }));
  EXPECT_CONTAINS(app_->data().messages.toasts().back().text, "recording.toml");
  go_round(5);
  EXPECT_EQ(app_->data().content.run.state, LiveState::running);
  EXPECT_EQ(options().source, "synthetic");
}

TEST_F(LiveApp, WhatIsCancelledIsNotOpened) {
  ASSERT_TRUE(comes_to(LiveState::running));
  drop(other_);
  app_->advance(now_s_ += 1e-3, size_);
  if (!app_->data().content.opening) GTEST_SKIP() << "skipped: it was there at once";
  key(static_cast<char>(Key::escape));
  go_round(50);
  std::this_thread::sleep_for(100ms);
  go_round(50);
  EXPECT_FALSE(app_->quitting()) << "Escape was for what loads";
  EXPECT_EQ(options().scene, scene_);
  EXPECT_EQ(app_->data().content.run.state, LiveState::running);
}

TEST_F(LiveApp, AFingerThatFollowsThePointerTouches) {
  begin("mouse");
  ASSERT_TRUE(comes_to(LiveState::running));
  ASSERT_TRUE(goes_round_until([&] { return app_->showed_frame(); }));
  go_round(5);
  EXPECT_FALSE(heard_->sounded()) << "it waits above the cube";
  point_at({0, -0.002, 0});
  EXPECT_TRUE(goes_round_until([&] { return heard_->sounded(); }));
  ASSERT_TRUE(goes_round_until([&] { return app_->picture().fingers.size() == 1; }));
  point_at({0, 0.02, 0});
  EXPECT_TRUE(goes_round_until([&] { return app_->picture().fingers.empty(); }));
}

TEST_F(LiveApp, AHandleThatIsReleasedWhileARunRestartsIsReleased) {
  begin("synthetic", "slice");
  ASSERT_TRUE(goes_round_until([&] { return app_->data().state.slice_handles; }));
  const auto middle = [&] {
    const ViewState& state = app_->data().state;
    return project(projection(state.viewpoint, size_.width, size_.height), place_of(SliceHandle::middle, state.slice));
  };
  const Projected at = middle();
  button(WindowEvent::Kind::press, at.x, at.y);
  write_again(scene_);
  ASSERT_TRUE(goes_round_until([&] { return !app_->data().state.slice_handles; }));
  button(WindowEvent::Kind::release, at.x, at.y);
  ASSERT_TRUE(goes_round_until([&] { return app_->data().state.slice_handles; }));
  const SliceState before = app_->data().state.slice;
  button(WindowEvent::Kind::move, at.x + 40, at.y + 30);
  EXPECT_EQ(app_->data().state.slice, before);
}

/// Pressures are shown on the mesh of the run that plays, not on the mesh of the previous run.
TEST_F(LiveApp, PressuresAreOnTheFingerOfThisRun) {
  const std::string open = (folder_ / "open.ply").string();
  geometry::Mesh mesh = geometry::icosphere(5e-3, 4);
  mesh.triangles.pop_back();  // a hole: cameras can see the mesh, but sound needs an inside
  for (Vec3& p : mesh.positions)
    p.y += 5e-3;
  geometry::write_ply(open, mesh.positions, mesh.triangles);
  const auto note = [&] {
    const auto& bars = app_->picture().bars;
    const auto bar = std::ranges::find(bars, Layer::heat, &ColourBar::layer);
    return bar == bars.end() ? std::string() : note_of(*bar);
  };
  begin("synthetic:" + open, "heat");
  ASSERT_TRUE(goes_round_until([&] { return note().find("failed") != std::string::npos; })) << note();
  ASSERT_FALSE(app_->data().messages.toasts().empty());
  EXPECT_CONTAINS(app_->data().messages.toasts().back().text, "open.ply");
  drop(recording());
  ASSERT_TRUE(goes_round_until([&] { return note().find("being computed") != std::string::npos; })) << note();
}

/// A recording is dropped on a touch.
TEST_F(LiveApp, ARecordingOnATouchIsALiveRunWithAllThatIsShownOfIt) {
  app_.reset();
  ViewerOptions options;
  options.input.scene = scene_;
  options.input.points = test::source_file("assets/finger.ply");
  options.input.penetration_m = 3e-3;
  options.common.backend = setup::Backend::cpu;
  options.layout = "autd3";
  options.given = {
      {"--spectrum", {}},         {"--spot", {"4mm"}},    {"--scene", {scene_}},  {"--points", {options.input.points}},
      {"--penetration", {"3mm"}}, {"--backend", {"cpu"}}, {"--layout", {"autd3"}}};
  AppHost host;
  int went_live = 0;
  host.stop = &stop_;
  host.panels = false;
  host.goes_live = [&] { ++went_live; };
  app_ = std::make_unique<App>(options, size_, std::move(host));
  EXPECT_FALSE(app_->data().content.live);
  drop(folder_ / "nowhere.txt");
  go_round();
  EXPECT_EQ(went_live, 0);
  const fs::path take = recording();
  drop(take);
  ASSERT_TRUE(comes_to(LiveState::running));
  EXPECT_EQ(went_live, 1);
  EXPECT_TRUE(app_->data().content.live);
  EXPECT_TRUE(goes_round_until([&] { return app_->picture().fingers.size() == 1; }));
  EXPECT_TRUE(app_->picture().driven);
  EXPECT_EQ(app_->data().content.edit.command(), "palpa run --scene " + scene_.string() + " --source recording:" +
                                                     take.string() + " --layout autd3 --backend cpu");
  EXPECT_TRUE(app_->finish(10));
}

TEST(Fingers, OfPressuresAreOfTheSource) {
  EXPECT_EQ(finger_mesh("", ""), "") << "a touch without --skin";
  EXPECT_EQ(finger_mesh("skin.ply", "synthetic:made.ply"), "skin.ply");
  EXPECT_EQ(finger_mesh("", "synthetic:made.ply"), "made.ply");
  EXPECT_EQ(finger_mesh("", "mouse:held.ply"), "held.ply");
  EXPECT_TRUE(finger_mesh("", "recording:take").ends_with("finger.ply"));
}

TEST(AppSettings, OfALineAreNotRemembered) {
  const fs::path folder = test::scratch_folder("viewer-app-settings"), file = folder / "viewer.toml";
  Settings before;
  before.layers[Layer::grid].visible = false;
  before.skin_colour = SkinColour::sa1;
  save_settings(file, before);
  std::atomic<bool> stop{false};
  ViewerOptions options;
  options.layout = "autd3";
  options.shown = "sections";
  AppHost host;
  host.stop = &stop;
  host.settings = file;
  host.panels = false;
  App app(options, {300, 200}, std::move(host));
  EXPECT_TRUE(app.data().state.layers.shows(Layer::sections));
  EXPECT_FALSE(app.data().state.layers.shows(Layer::grid)) << "of this the line said nothing";
  EXPECT_EQ(app.data().state.skin_colour, SkinColour::sa1);
  EXPECT_TRUE(app.finish(1));
  EXPECT_EQ(load_settings(file), before);
}

}  // namespace
}  // namespace palpa::viewer
