// The viewer without its window: a live run starts, ends and restarts in it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <numbers>

#include "base/files/outputs.hpp"
#include "geometry/files/ply.hpp"
#include "geometry/mesh/icosphere.hpp"
#include "live_app.hpp"
#include "support/files.hpp"
#include "support/shapes.hpp"
#include "support/thrown.hpp"
#include "viewer/app/keys.hpp"
#include "viewer/app/pick.hpp"
#include "viewer/picture/field_marks.hpp"

namespace palpa::viewer {
namespace {

TEST_F(LiveApp, AllOffLastsWhateverChanges) {
  ASSERT_TRUE(goes_round_until([&] { return heard_->sounded(); }));
  all_off();
  ASSERT_TRUE(comes_to(LiveState::ended));
  EXPECT_TRUE(stays_off());
  write_again(scene_);
  EXPECT_TRUE(stays_off()) << "the scene was written again";
  drop(other_);
  EXPECT_TRUE(stays_off()) << "another scene";
  EXPECT_TRUE(opens_other()) << "is what Start begins";
}

TEST_F(LiveApp, AllOffWinsOverARestart) {
  for (const bool pending : {true, false}) {
    begin("synthetic");
    ASSERT_TRUE(comes_to(LiveState::running));
    drop(other_);
    // The restart is pending: the old run has not ended yet, or the new one has just begun. Otherwise it was only asked
    // for.
    if (pending) {
      ASSERT_TRUE(opens_other());
    }
    all_off();
    ASSERT_TRUE(comes_to(LiveState::ended));
    EXPECT_TRUE(stays_off()) << pending;
  }
}

TEST_F(LiveApp, ASceneThatIsWrittenAgainRestartsWithItsOptionsAndAnotherSceneWithout) {
  const auto copied = [&] {
    key('c', true);
    go_round();
    return copied_;
  };
  const std::string rest = " --source synthetic --hold 5s --noise-free --link heard --layout autd3 --backend cpu";
  ASSERT_TRUE(comes_to(LiveState::running));
  go_round(11);
  write_again(scene_);
  ASSERT_TRUE(comes_to(LiveState::loading));
  ASSERT_TRUE(comes_to(LiveState::running));
  EXPECT_EQ(copied(), "palpa run --scene " + scene_.string() + " --gltf-scene 0" + rest);
  go_round(11);
  write_again(other_);
  drop(other_);
  ASSERT_TRUE(opens_other());
  ASSERT_TRUE(comes_to(LiveState::loading));
  ASSERT_TRUE(comes_to(LiveState::running));
  EXPECT_EQ(copied(), "palpa run --scene " + other_.string() + rest) << "the number was of the one before";
  go_round(50);
  EXPECT_EQ(state(), LiveState::running) << "it was not written again";
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
  EXPECT_EQ(state(), LiveState::failed);
  EXPECT_EQ(heard_->opened, runs) << "nobody chose Start";
  EXPECT_TRUE(
      app_->data().messages.log().back().text.ends_with("cube.glb: was written again; Start begins a run with it"));
}

TEST_F(LiveApp, ASceneThatIsRepairedBeginsTheRunThatFailedOnIt) {
  const std::string whole = test::read_text(scene_);
  test::write_text(scene_, whole.substr(0, whole.size() / 2));
  begin("synthetic");
  ASSERT_TRUE(comes_to(LiveState::failed));
  go_round(11);
  test::write_text(scene_, whole);
  write_again(scene_);
  EXPECT_TRUE(comes_to(LiveState::running));
}

TEST_F(LiveApp, SavesNoSceneOverAFileThatIsRead) {
  const auto kept = keep_register();
  begin("synthetic:" + test::source_file("assets/finger.ply").string());
  ASSERT_TRUE(comes_to(LiveState::running));
  const std::string before = test::read_text(scene_);
  fs::create_symlink(scene_, folder_ / "soft.glb");
  for (const fs::path& file : {scene_, folder_ / "soft.glb", folder_ / ".." / folder_.filename() / scene_.filename()}) {
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

/// The run is off, Start is clicked, and the key is pressed before a picture shows this: the last input counts.
TEST_F(LiveAppWithPanels, AllOffWinsOverAStartThatNoPictureHasShown) {
  for (const bool pressed_before : {false, true}) {
    ASSERT_TRUE(comes_to(LiveState::running));
    draw();
    all_off();
    ASSERT_TRUE(comes_to(LiveState::ended));
    draw();
    const Area start = app_->data().places.start.value_or(Area());
    const double x = (start.left + start.right) / 2, y = (start.top + start.bottom) / 2;
    button(Kind::move, x, y);
    draw();
    button(Kind::press, x, y);
    if (pressed_before) draw(1);
    button(Kind::release, x, y);
    if (pressed_before) app_->render(size_, 1, now_s_);  // requested, but not done yet
    all_off();
    draw();
    EXPECT_TRUE(stays_off()) << pressed_before;
    const std::uint64_t before = heard_->sounding;
    click(start);
    ASSERT_TRUE(comes_to(LiveState::running)) << "a click after it begins a run";
    EXPECT_FALSE(stop_);
    EXPECT_TRUE(goes_round_until([&] { return heard_->sounding > before; })) << "it sounds again";
  }
}

struct Options : LiveAppWithPanels {
  Options() : LiveAppWithPanels({900, 1600}) {}
};

TEST_F(Options, ThatHaveChangedHaveADot) {
  make_touch();
  click("Run");
  click("Touch");
  const Area field = place_of_widget("--delta").value_or(Area());
  ASSERT_LT(field.top, field.bottom);
  const auto corners_before_the_field = [&] {
    draw();
    const App::Frame frame = app_->render(size_, 1, now_s_);
    return std::ranges::count_if(frame.sheet->corners, [&](const shader::SheetCorner& corner) {
      return corner.place.x < field.left && corner.place.y > field.top && corner.place.y < field.bottom;
    });
  };
  const auto usual = corners_before_the_field();
  type("--delta", "3mm");
  EXPECT_GE(corners_before_the_field(), usual + 12) << "a small circle";
  click("--delta reset");
  EXPECT_EQ(corners_before_the_field(), usual);
}

TEST_F(LiveAppWithPanels, AllOffWaitsForNoPicture) {
  ASSERT_TRUE(comes_to(LiveState::running));
  draw();
  for (int i = 0; i < 50; ++i) {  // keys that are held down; each change takes a picture
    key('.');
    send({.kind = Kind::key, .key = key_of('.'), .down = false});
  }
  const Area off = all_off_button();
  ASSERT_GT(off.right, off.left);
  button(Kind::press, off.left + 2, off.top + 2);
  EXPECT_TRUE(stop_) << "before anything was drawn";
  ASSERT_TRUE(comes_to(LiveState::ended));
  button(Kind::release, off.left + 2, off.top + 2);
  draw();
  EXPECT_TRUE(stays_off());
}

TEST_F(LiveApp, ASwitchThatIsHeldDownIsThrownOnce) {
  key('h');
  send({.kind = Kind::key, .key = key_of('h'), .repeat = true});
  EXPECT_TRUE(app_->data().help);
  const double before = app_->data().state.time.slots_per_s;
  send({.kind = Kind::key, .key = key_of('-'), .repeat = true});
  EXPECT_LT(app_->data().state.time.slots_per_s, before) << "slower and slower";
}

/// Each key, whatever it does: those that step something go on, and no others.
TEST(Keys, StepWhileTheyAreHeldDown) {
  int steps = 0;
  for (int character = 1; character < 128; ++character) {
    const WindowEvent event{
        .kind = WindowEvent::Kind::key, .key = key_of(static_cast<char>(character)), .repeat = true};
    PanelData data;
    const double slots_per_s = data.state.time.slots_per_s;
    ask_by_key(event, data);
    const bool step =
        data.asked.step != 0 || data.asked.slots != 0 || data.state.time.slots_per_s != slots_per_s || character == 'z';
    EXPECT_EQ(goes_on(event), step) << character;
    steps += step;
  }
  EXPECT_EQ(steps, 8) << "left right , . - + = and undo";
}

TEST_F(LiveApp, ABrokenFileEndsNothing) {
  test::write_text(folder_ / "broken.glb", "no glTF");
  fs::create_directory(folder_ / "broken");
  test::write_text(folder_ / "broken" / "recording.toml", "[recording]\n");
  ASSERT_TRUE(comes_to(LiveState::running));
  for (const auto& [file, told] : {std::pair("broken.glb", "broken.glb"), {"broken", "recording.toml"}}) {
    drop(folder_ / file);
    EXPECT_TRUE(comes_to_say(told)) << told;
    go_round(5);
    EXPECT_EQ(state(), LiveState::running);
  }
  EXPECT_EQ(options().scene, scene_);
  EXPECT_EQ(options().source, "synthetic");
  make_touch();
  drop(folder_ / "broken");
  EXPECT_TRUE(comes_to_say("recording.toml"));
  EXPECT_FALSE(app_->data().content.live) << "the touch stays";
}

TEST_F(LiveApp, WhatIsCancelledIsNotOpened) {
  ASSERT_TRUE(comes_to(LiveState::running));
  drop(other_);
  app_->advance(now_s_ += 1e-3, size_);
  if (!app_->data().content.opening) GTEST_SKIP() << "skipped: it was there at once";
  key(Key::escape);
  const auto before = std::chrono::steady_clock::now();
  EXPECT_TRUE(goes_round_until([&] { return std::chrono::steady_clock::now() - before > 100ms; }));
  EXPECT_FALSE(app_->quitting()) << "Escape was for what loads";
  EXPECT_EQ(options().scene, scene_);
  EXPECT_EQ(state(), LiveState::running);
}

TEST_F(LiveApp, AHandleThatIsReleasedWhileARunRestartsIsReleased) {
  begin("synthetic", {.shown = "slice"});
  const auto has_handles = [&] { return app_->data().state.slice_handles; };
  ASSERT_TRUE(goes_round_until(has_handles));
  const ViewState& seen = app_->data().state;
  const Projected at = pixel_of(place_of(SliceHandle::middle, seen.slice));
  button(Kind::press, at.x, at.y);
  write_again(scene_);
  ASSERT_TRUE(goes_round_until(std::not_fn(has_handles)));
  button(Kind::release, at.x, at.y);
  ASSERT_TRUE(goes_round_until(has_handles));
  const SliceState before = seen.slice;
  button(Kind::move, at.x + 40, at.y + 30);
  EXPECT_EQ(seen.slice, before);
}

TEST_F(LiveApp, ACtrlClickReadsWhatIsNearestAndHowDeepItIs) {
  make_touch();
  const auto read_at = [&](const Vec3& world) {
    const Projected at = pixel_of(world);
    app_->render(size_, 1, now_s_);
    EXPECT_FALSE(app_->dirty());
    send({.kind = Kind::press, .x = at.x, .y = at.y, .ctrl = true});
    EXPECT_TRUE(app_->dirty()) << "what was read is drawn";
    return app_->data().reading.value_or(Reading());
  };
  for (const bool behind : {false, true}) {
    key('1', behind);
    const Vec3 seen(0.005, -0.03, behind ? -0.02 : 0.02);
    const Reading face = read_at(seen);
    EXPECT_EQ(face.what, app_->picture().solids.at(0).name);
    EXPECT_LT(glm::distance(face.at, seen), 1e-4) << behind;
    EXPECT_FALSE(face.depth_m);
  }
  EXPECT_GT(read_at(Vec3(app_->picture().contacts.at(0).position)).depth_m.value_or(0), 0);
  key(Key::escape);
  EXPECT_FALSE(app_->data().reading);
  EXPECT_FALSE(app_->quitting());
}

TEST(Pick, APlaceInSeveralSolidsIsAsDeepAsInTheOneWhereItIsDeepest) {
  const Vec3 at(0, 0.001, 0.002);
  const SurfaceMark around{"around", test::box(Vec3(-0.02), Vec3(0.02))};
  const SurfaceMark thin{"thin", test::box(Vec3(-0.02, -0.002, -0.02), Vec3(0.02, 0.004, 0.02))};
  const SurfaceMark aside{"aside", test::box(Vec3(0.03, -0.02, -0.02), Vec3(0.05, 0.02, 0.02))};
  ViewState state;
  state.layers[Layer::points].visible = true;
  const Projected pixel = project(projection(state.viewpoint, 400, 300), at);
  const auto deep = [&](std::vector<SurfaceMark> solids) {
    Picture picture;
    picture.solids = std::move(solids);
    picture.skin_points = {glm::vec3(at)};
    const std::optional<Reading> reading = pick(picture, state, pixel.x, pixel.y, 400, 300, 1);
    EXPECT_TRUE(reading && reading->what == "skin point");
    return reading.value_or(Reading()).depth_m;
  };
  for (const auto& solids : {std::vector{around, thin, aside}, {aside, thin, around}, {thin, aside, around}})
    EXPECT_NEAR(deep(solids).value_or(0), 0.018, 1e-6) << solids[0].name;
  EXPECT_NEAR(deep({thin, aside}).value_or(0), 0.003, 1e-6);
  EXPECT_FALSE(deep({aside}));
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
  begin("synthetic:" + open, {.shown = "heat"});
  ASSERT_TRUE(goes_round_until([&] { return note().find("failed") != std::string::npos; })) << note();
  EXPECT_TRUE(has_said("open.ply"));
  drop(recording());
  ASSERT_TRUE(goes_round_until([&] { return note().find("being computed") != std::string::npos; })) << note();
}

TEST_F(LiveApp, ARecordingOnATouchIsALiveRunWithAllThatIsShownOfIt) {
  make_touch({{"--layout", {"autd3"}}, {"--spectrum", {}}, {"--spot", {"4mm"}}});
  EXPECT_FALSE(app_->data().content.live);
  drop(folder_ / "nowhere.txt");
  go_round();
  EXPECT_EQ(went_live_, 0);
  const fs::path take = recording();
  drop(take);
  ASSERT_TRUE(comes_to(LiveState::running));
  EXPECT_EQ(went_live_, 1);
  EXPECT_TRUE(app_->data().content.live);
  EXPECT_TRUE(goes_round_until([&] { return app_->picture().fingers.size() == 1; }));
  EXPECT_TRUE(app_->picture().driven);
  EXPECT_EQ(app_->data().content.edit.command(), "palpa run --scene " + scene_.string() + " --source recording:" +
                                                     take.string() + " --layout autd3 --backend cpu");
  EXPECT_TRUE(app_->finish(10));
}

TEST_F(LiveApp, ARecordingInPlaceOfOneThatHasHardlyBegunGoesBackToTheSourceBefore) {
  const fs::path first = recording(), second = folder_ / "second";
  fs::copy(first, second);
  ASSERT_TRUE(comes_to(LiveState::running));
  for (const fs::path& take : {first, second}) {
    drop(take);
    ASSERT_TRUE(goes_round_until([&] { return options().source == "recording:" + take.string(); }));
  }
  EXPECT_EQ(app_->data().content.before, "synthetic");
}

TEST(MeshOfPressures, IsTheSkinOrTheFingerOfTheSource) {
  EXPECT_EQ(finger_mesh("", ""), "") << "a touch without --skin";
  EXPECT_EQ(finger_mesh("skin.ply", "synthetic:made.ply"), "skin.ply");
  EXPECT_EQ(finger_mesh("", "synthetic:made.ply"), "made.ply");
  EXPECT_EQ(finger_mesh("", "mouse:held.ply"), "held.ply");
  EXPECT_TRUE(finger_mesh("", "recording:take").ends_with("finger.ply"));
}

TEST_F(LiveApp, ASensationPlaysInItsTimeAndPauses) {
  make(options_of({{"--sensation", {"circle"}}, {"--layout", {"openmpd"}}}));
  EXPECT_EQ(app_->title(), "circle");
  go_round();
  const auto slot = [&] { return app_->data().state.time.slot; };
  const std::uint64_t begin = slot();
  go_round(10);
  EXPECT_NEAR(static_cast<double>(slot() - begin), 1 / 0.875e-3, 200) << "a second";
  const auto& marks = app_->picture().fingers.at(0);
  const double w = 2 * std::numbers::pi * 70 * 0.875e-3 * static_cast<double>(slot());
  // The layout's x, y, z are the world's x, -z, y, and the array is 150 mm below.
  const Vec3 there(0.01 * std::cos(w), 0.05, -0.01 * std::sin(w));
  EXPECT_LT(glm::distance(Vec3(marks.foci.at(*marks.running).position), there), 1e-6);
  EXPECT_EQ(marks.foci.size(), 16U);
  EXPECT_TRUE(app_->picture().driven);
  key(Key::space);
  go_round();
  const std::uint64_t paused = slot();
  go_round(5);
  EXPECT_EQ(slot(), paused);
  key(Key::space);
  go_round(5);
  EXPECT_GT(slot(), paused);
}

TEST(AppSettings, WhatTheCommandLineSaysIsNotRemembered) {
  const fs::path file = test::scratch_folder("viewer-app-settings") / "viewer.toml";
  Preferences before;
  before.layers[Layer::grid].visible = false;
  before.skin_colour = SkinColour::sa1;
  save_preferences(file, before);
  std::atomic<bool> stop{false};
  App app({.layout = "autd3", .shown = "sections"}, {300, 200}, {.stop = &stop, .panels = false, .settings = file});
  EXPECT_TRUE(app.data().state.layers.shows(Layer::sections));
  EXPECT_FALSE(app.data().state.layers.shows(Layer::grid)) << "of this the line said nothing";
  EXPECT_EQ(app.data().state.skin_colour, SkinColour::sa1);
  EXPECT_TRUE(app.finish(1));
  EXPECT_EQ(load_preferences(file), before);
  App playing({.sensation = "circle"}, {300, 200}, {.stop = &stop, .panels = false, .settings = file});
  EXPECT_GT(playing.data().state.time.slots_per_s, 1000);
  EXPECT_TRUE(playing.finish(1));
  EXPECT_EQ(load_preferences(file), before);
}

}  // namespace
}  // namespace palpa::viewer
