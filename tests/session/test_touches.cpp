// When touches begin, press and end: the same for events and for what a finger feels.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/ext/matrix_transform.hpp>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "fakes.hpp"
#include "sensing/joints/capsules.hpp"
#include "sensing/joints/hand_check.hpp"
#include "sensing/joints/tracker.hpp"
#include "session/session.hpp"
#include "session/watch/touches.hpp"
#include "support/hand_films.hpp"
#include "support/shared_data.hpp"
#include "support/tracked_hands.hpp"
#include "support/watched_heap.hpp"
#include "touch/contacts/prepared_solids.hpp"
#include "touched_scene.hpp"

namespace palpa::session {
namespace {

struct Tip {
  std::uint32_t id = 0;
  float x_m = 0, depth_m = 0.004F;
};

touch::Touch touching(const std::vector<Tip>& tips) {
  touch::Touch touch;
  for (const Tip& tip : tips) {
    touch::Finger finger;
    finger.id = tip.id;
    finger.depth_m = tip.depth_m;
    finger.section.centroid = {tip.x_m, 0, 0};
    touch.fingers.push_back(finger);
  }
  touch.finger_count = static_cast<std::uint32_t>(tips.size());
  return touch;
}

struct TouchesOf : ::testing::Test {
  std::vector<geometry::Solid> solids = std::vector<geometry::Solid>(1);
  TouchesOf() { solids[0].haptics.press_depth_m = 0.003; }

  /// A finger presses, is missing for `away_s`, in frames that show so many hands, and comes back as `back`.
  HeldTouch touch_after(double away_s, std::uint32_t hands, const Tip& back) const {
    Touches touches{solids};
    double time_s = 1;
    touches.update(touching({{1, 0, 0.001F}}), time_s, 2);
    touches.update(touching({{1}}), time_s += 0.01, 2);
    EXPECT_TRUE(touches.held()[0].presses);
    for (double away = 0.01; away < away_s; away += 0.01)
      touches.update({}, time_s + away, hands);
    touches.update(touching({back}), time_s + away_s, 2);
    return touches.held()[0];
  }
  bool presses_again(double away_s, std::uint32_t hands, const Tip& back) const {
    return touch_after(away_s, hands, back).presses;
  }
};

TEST_F(TouchesOf, AHandThatIsLostWhileItPressesDoesNotPressAgain) {
  for (const double away_s : {0.03, 0.07, 0.1, 0.15, 0.19}) {
    EXPECT_FALSE(presses_again(away_s, 0, {1})) << away_s;
    EXPECT_FALSE(presses_again(away_s, 1, {7, 0.01F})) << away_s << " s later it has another number; one hand is left";
  }
  EXPECT_TRUE(presses_again(0.3, 0, {7})) << "later";
  EXPECT_TRUE(presses_again(0.1, 2, {7})) << "the hand was seen elsewhere";
  EXPECT_TRUE(presses_again(0.1, 0, {7, 0.03F})) << "30 mm beside it";
  EXPECT_FALSE(presses_again(0.1, 0, {7, 0, 0.0025F})) << "it has not come up";
}

TEST_F(TouchesOf, ALightTouchAfterALostPressNeitherPressesNorLifts) {
  for (const double away_s : {0.07, 0.1, 0.12, 0.16, 0.19}) {
    const HeldTouch back = touch_after(away_s, 0, {7, 0.01F, 0.0005F});
    EXPECT_TRUE(back.begins) << away_s;
    EXPECT_FALSE(back.presses || back.lifts || back.pressed) << away_s;
  }
}

TEST_F(TouchesOf, AHandInDoubtDoesNotPressAgainHoweverLongTheDoubtLasts) {
  for (const double doubt_s : {0.03, 0.1, 0.25, 0.3, 3.0}) {
    Touches touches{solids};
    touches.update(touching({{1}}), 1, 19);
    for (double after_s = 0.01; after_s < doubt_s; after_s += 0.01)
      touches.update({}, 1 + after_s, std::nullopt);
    touches.update(touching({{2}}), 1 + doubt_s, 19);
    EXPECT_FALSE(touches.held()[0].presses) << doubt_s;
    EXPECT_TRUE(touches.held()[0].pressed) << doubt_s;
  }
  Touches touches{solids};
  touches.update(touching({{1}}), 1, 19);
  touches.update({}, 1.1, std::nullopt);
  touches.update({}, 1.1 + lost_press_s + 0.01, 0);
  touches.update(touching({{2}}), 1.12 + lost_press_s, 19);
  EXPECT_TRUE(touches.held()[0].presses) << "without doubt, the time passes";
}

TEST_F(TouchesOf, APressThatWasLostIsOverWhenItsHandComesBackElsewhere) {
  Touches touches{solids};
  touches.update(touching({{1}}), 1.00);
  touches.update({}, 1.10, 0);
  ASSERT_EQ(touches.ended().size(), 1U);
  EXPECT_NEAR(touches.ended()[0].time_s, 1.05, 1e-12);
  touches.update({}, 1.12, 1);
  touches.update(touching({{2}}), 1.14);
  EXPECT_TRUE(touches.held()[0].presses);
}

TEST_F(TouchesOf, AnotherSceneTakesOverWhatPresses) {
  for (const bool over : {false, true}) {
    Touches before{solids}, after{solids};
    before.update(touching({{1}, {2, 0.05F, 0.001F}}), 1.00);
    if (over) before.end();
    after.take_over(before);
    after.update(touching({{8, 0.05F}, {9}}), 1.01);
    EXPECT_TRUE(after.held()[0].presses) << "it did not press before";
    EXPECT_FALSE(after.held()[1].presses);
    EXPECT_TRUE(after.held()[1].pressed);
  }
}

TEST_F(TouchesOf, AFrameAllocatesNothing) {
  Touches touches{solids};
  const touch::Touch some = touching({{1}, {2, 0.05F}}), none;
  EXPECT_EQ(test::allocations_of([&] {
              for (int i = 0; i < 200; ++i)
                touches.update(i % 20 < 10 ? some : none, 0.01 * i, i % 40 < 20 ? 0 : 1);
            }),
            0U);
}

/// The hands of frames in a session with a button that clicks: how often events say that it is pressed, and how often
/// it clicks.
struct Button {
  static constexpr double frame_s = 1.0 / 90;
  Session session;
  double time_s = 0;
  std::uint64_t slot = 0;
  int presses = 0, clicks = 0, releases = 0;
  bool clicking = false;

  static SessionSetting setting() {
    SessionSetting setting{.solids = test::asset_solids("cube"), .tracked = true, .layout = test::small_layout()};
    setting.touch.delta_m = 3e-3;
    setting.solids[0].haptics.intensity = 0.5;
    setting.solids[0].haptics.press_depth_m = 0.0015;
    setting.solids[0].haptics.click.emplace();
    return setting;
  }
  explicit Button(SessionSetting given = setting()) : session(std::move(given)) {}

  void see(const std::vector<sensing::TrackedHand>& hands, bool in_doubt = false) {
    std::vector<sensing::Capsule> bones;
    for (const sensing::TrackedHand& hand : hands)
      sensing::append_capsules(hand, Transform(1.0), bones);
    session.touch(bones, time_s, slot, in_doubt);
    count();
  }
  void see_images(const std::vector<sensing::DepthFrame>& images) {
    session.touch(images, time_s, slot);
    count();
  }
  void count() {
    time_s += frame_s;
    slot += 7;
    for (const Event& event : session.events()) {
      presses += event.kind == EventKind::press ? 1 : 0;
      releases += event.kind == EventKind::release ? 1 : 0;
    }
    const array::Schedule& schedule = session.schedule();
    const bool clicks_now = schedule.voice_count > 0 && schedule.voices[0].modulation_hz == 200;
    clicks += clicks_now && !clicking ? 1 : 0;
    clicking = clicks_now;
  }
  /// A fingertip so deep in the cube for so many frames.
  void hold(double depth_m, int frames) {
    for (int i = 0; i < frames; ++i)
      see({test::pointing_hand({1e-6 * static_cast<double>(slot), 7e-3 - depth_m, 0})});
  }
  void lose(int frames) {
    for (int i = 0; i < frames; ++i)
      see({});
  }
};

TEST(Button, DoesNotClickAgainForAHandThatWasLost) {
  for (const int frames : {6, 7, 10, 13}) {
    Button button;
    button.hold(-0.02, 5);
    button.hold(0.004, 15);
    button.lose(frames);
    button.hold(0.004, 15);
    EXPECT_EQ(button.presses, 1) << frames;
    EXPECT_EQ(button.clicks, 1) << frames;
    EXPECT_EQ(button.releases, 1) << frames;
  }
}

/// A tracker takes the hand for the other one in some frames, and moves it by 30 mm in them.
TEST(Button, DoesNotClickAgainForAHandThatChangesItsSide) {
  struct Flips {
    double every_s, for_s;
  };
  for (const double rate_hz : {30.0, 90.0}) {
    for (const Flips flips : {Flips{9, 0.01}, {9, 0.15}, {0.3, 0.01}, {0.3, 0.15}}) {
      Button button;
      sensing::HandCheck check;
      const auto see = [&](double depth_m, bool flipped) {
        sensing::TrackedHand hand =
            test::pointing_hand({(flipped ? 0.03 : 0) + 1e-6 * static_cast<double>(button.slot), 7e-3 - depth_m, 0});
        hand.left = flipped;
        sensing::TrackedFrame frame{button.time_s, {hand}};
        check.check(frame, frame.time_s);
        button.see(frame.hands, frame.in_doubt);
        button.time_s += 1 / rate_hz - Button::frame_s;
      };
      const int second = static_cast<int>(rate_hz);
      for (int i = 0; i < second; ++i)
        see(-0.005, false);
      for (int i = 0; i < 2 * second; ++i)
        see(0.004, i >= second / 2 && std::fmod((i - second / 2) / rate_hz + 1e-9, flips.every_s) < flips.for_s);
      for (int i = 0; i < second; ++i)
        see(0.004, false);
      EXPECT_EQ(button.presses, 1) << rate_hz << " Hz, " << flips.every_s << ", " << flips.for_s;
      EXPECT_EQ(button.clicks, 1) << rate_hz << " Hz, " << flips.every_s << ", " << flips.for_s;
    }
  }
}

/// Depth cameras see a finger that presses, then for some frames nothing or a finger that has come up, then the first.
struct Filmed {
  static constexpr std::size_t before = 8, after = 6;
  int presses = 0, clicks = 0;

  Filmed(std::size_t away, double lift_m, bool lost) {
    const auto is_away = [=](double time_s) {
      const auto frame = static_cast<std::size_t>(std::lround(time_s / Button::frame_s));
      return frame >= before && frame < before + away;
    };
    test::HandFilm film = test::make_film(
        test::fingers_scene(1, 18e-3, 3e-3, 0),
        {.cameras = 1,
         .frames = before + away + after,
         .noise = test::FilmNoise::half,
         .motion = [=](std::size_t, double time_s) { return Vec3(0, is_away(time_s) ? lift_m : 0, 0); }});
    SessionSetting setting = Button::setting();
    setting.tracked = false;
    setting.cameras = film.cameras;
    Button button(std::move(setting));
    for (sensing::FrameSet& set : film.frames) {
      for (sensing::DepthFrame& image : set.frames) {
        if (lost && is_away(set.time_s)) std::ranges::fill(image.depth, std::uint16_t{0});
      }
      button.see_images(set.frames);
    }
    presses = button.presses;
    clicks = button.clicks;
  }
};

TEST(Button, DoesNotClickAgainForAHandThatCamerasHaveLost) {
  for (const std::size_t away : {3U, 7U, 10U, 13U}) {  // 33 to 144 ms
    const Filmed lost(away, 0, true);
    EXPECT_EQ(lost.presses, 1) << away;
    EXPECT_EQ(lost.clicks, 1) << away;
  }
  const Filmed later(23, 0, true);
  EXPECT_EQ(later.presses, 2) << "256 ms";
}

TEST(Button, ClicksAgainForAFingerThatCamerasSawInTheAir) {
  for (const double lift_m : {0.004, 0.02, 0.08}) {
    const Filmed lifted(7, lift_m, false);
    EXPECT_EQ(lifted.presses, 2) << lift_m;
    EXPECT_EQ(lifted.clicks, 2) << lift_m;
  }
}

TEST(Button, ThatIsTakenAwayIsForgotten) {
  Button button;
  button.hold(-0.02, 5);
  button.hold(0.004, 15);
  button.session.set_pose(0, glm::translate(Transform(1.0), Vec3(0, -2 * touch::out_of_reach_m, 0)));
  button.hold(0.004, 9);
  button.session.set_pose(0, Transform(1.0));
  button.hold(0.0005, 30);
  EXPECT_EQ(button.presses, 1);
  EXPECT_EQ(button.clicks, 1);
}

TEST(Button, DoesNotClickBecauseItsSceneIsReadAgain) {
  Button button;
  button.hold(-0.02, 5);
  button.hold(0.004, 15);
  for (int reload = 0; reload < 5; ++reload) {
    Session next(Button::setting());
    button.session.exchange_scene(next);
    button.hold(0.004, 15);
  }
  EXPECT_EQ(button.presses, 1);
  EXPECT_EQ(button.clicks, 1);
  button.hold(0.0005, 15);
  EXPECT_EQ(button.clicks, 2) << "as it comes up";
  button.hold(0.004, 15);
  EXPECT_EQ(button.presses, 2);
  EXPECT_EQ(button.clicks, 3);
}

TEST(Button, HasTheTouchesOfTheFoundFiles) {
  const std::pair<const char*, int> table[]{{"tap-then-light-100ms", 1}, {"two-taps-80ms", 2}};
  for (const auto& [name, wanted] : table) {
    PALPA_SHARED_OR_SKIP(file, std::string("found/") + name + ".jsonl");
    SessionSetting setting = Button::setting();
    setting.solids = geometry::make_solids(geometry::load_gltf(test::shared_data("found/button.glb")));
    Button button(std::move(setting));
    const auto tracker = sensing::open_tracker(file.string(), false);
    sensing::TrackedFrame frame;
    bool came = false;
    std::uint64_t number = 0;
    while (tracker->next(frame, came, number, 0))
      button.see(frame.hands, frame.in_doubt);
    EXPECT_EQ(button.presses, wanted) << name;
    EXPECT_EQ(button.clicks, wanted) << name;
  }
}

/// A spring's force and a texture's motion in the first frame of a light touch, 100 ms after a deep, fast one.
TEST(Feel, OfATouchBeginsAnew) {
  geometry::Haptics haptics;
  haptics.stiffness = std::vector<geometry::DepthForce>{{0, 0}, {0.01, 1}};
  haptics.texture = {0.2, 1, 0.6};
  haptics.grain_m = 0.002;
  const auto solids = test::solids_with({haptics});
  Scheduler scheduler("scene.glb", solids, {}, {});
  array::Schedule schedule;
  array::reserve(schedule, touch::max_fingers, touch::max_foci);
  double time_s = 1;
  std::uint64_t slot = 0;
  const auto see = [&](const std::vector<Tip>& tips) {
    touch::Touch touch = touching(tips);
    for (touch::Finger& finger : touch.fingers)
      finger.foci.assign(10, {finger.section.centroid, 7});
    scheduler.make(touch, time_s += 0.01, schedule, {true, slot += 7});
  };
  for (int i = 0; i < 10; ++i)
    see({{1, 0.002F * static_cast<float>(i), 0.009F}});
  for (int i = 0; i < 9; ++i)
    see({});
  see({{1, 0.02F, 0.001F}});
  const array::Voice& voice = schedule.voices[0];
  EXPECT_FALSE(voice.course.changes()) << "it rests, and its force is that of its depth";
  EXPECT_NEAR(voice.gain, std::sqrt(0.1 * 0.2 / 1.8), 1e-6);
}

TEST(Feel, ClicksWhereEventsPress) {
  geometry::Haptics haptics;
  haptics.intensity = 0.5;
  haptics.press_depth_m = 0.003;
  haptics.click.emplace();
  const auto solids = test::solids_with({haptics});
  std::mt19937 random(11);
  Scheduler scheduler("scene.glb", solids, {}, {});
  EventTracker tracker(solids);
  array::Schedule schedule;
  array::reserve(schedule, touch::max_fingers, touch::max_foci);
  double time_s = 0, pressed_s = -1;
  std::uint64_t slot = 0;
  int presses = 0;
  for (int n = 0; n < 3000; ++n) {
    // Slow presses, with gaps of every length.
    time_s += random() % 30 == 0 ? 1e-3 * static_cast<double>(random() % 300) : 0.01;
    const std::uint32_t hands = random() % 2;
    touch::Touch touch;
    if (random() % 12 > 2) touch = touching({{0, 0, n / 15 % 2 == 0 ? 0.001F : 0.004F}});
    for (touch::Finger& finger : touch.fingers)
      finger.foci.assign(10, {finger.section.centroid, 7});
    bool pressed = false;
    for (const Event& event : tracker.update(touch, time_s, hands))
      pressed = pressed || event.kind == EventKind::press;
    scheduler.make(touch, time_s, schedule, {true, slot += 7, hands});
    if (!pressed) continue;
    ++presses;
    if (time_s - std::exchange(pressed_s, time_s) > 0.3) {
      EXPECT_EQ(schedule.voices[0].modulation_hz, 200) << n;
    }
  }
  EXPECT_GT(presses, 50);
}

}  // namespace
}  // namespace palpa::session
