// Fingers of the frame before decide which clusters are fingers: films of hands and fingers that flicker without it.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <set>
#include <utility>
#include <vector>

#include "geometry/gltf/gltf.hpp"
#include "sensing/recording.hpp"
#include "support/hand_films.hpp"
#include "support/shared_data.hpp"
#include "touch/fingers/known.hpp"
#include "touch/harness.hpp"

namespace palpa::touch::test {
namespace {

using palpa::test::FilmNoise;
using palpa::test::fingers_scene;
using palpa::test::HandFilm;
using palpa::test::HandScene;

std::vector<geometry::Solid> plate_of(const HandFilm& film) {
  return {box({-0.3, -film.scene.plate_m, -0.3}, {0.3, 0, 0.3}, "plate")};
}

StageSetting holding(Hysteresis hysteresis = Hysteresis::on) {
  return {.follow = true, .hysteresis = hysteresis};
}

/// The ids of the fingers of each frame.
std::vector<std::vector<std::uint32_t>> ids_in(const HandFilm& film, const StageSetting& setting) {
  Stage stage(plate_of(film), film.cameras, setting);
  Touch touch;
  std::vector<std::vector<std::uint32_t>> all;
  for (const sensing::FrameSet& set : film.frames) {
    stage.touch(set.frames, touch, set.time_s);
    std::vector<std::uint32_t>& ids = all.emplace_back();
    for (std::uint32_t f = 0; f < touch.finger_count; ++f)
      ids.push_back(touch.fingers[f].id);
    std::ranges::sort(ids);
  }
  return all;
}

int changes_in(const std::vector<std::vector<std::uint32_t>>& ids, std::size_t from) {
  int changes = 0;
  for (std::size_t k = from + 1; k < ids.size(); ++k)
    changes += ids[k] != ids[k - 1] ? 1 : 0;
  return changes;
}

TEST(KnownFingers, StayApartWhereOneFrameAloneCannotTell) {
  const HandFilm film = make_film(fingers_scene(2, 14e-3, 2e-3, 0), {.cameras = 1, .frames = 27});
  EXPECT_GE(changes_in(ids_in(film, holding(Hysteresis::off)), 9), 3) << "the film does not flicker";
  const auto ids = ids_in(film, holding());
  EXPECT_EQ(changes_in(ids, 9), 0);
  EXPECT_EQ(ids.back().size(), 2U);
}

TEST(KnownFingers, ContinueWithHalfOfMinPoints) {
  // Two thirds of the contacts of the first frames are left.
  const auto rises = [](std::size_t, double t) { return Vec3(0, t > 0.03 ? 1.4e-3 : 0, 0); };
  const HandFilm film = make_film(fingers_scene(1, 18e-3, 2e-3, 0), {.cameras = 1, .frames = 8, .motion = rises});
  Stage counts(plate_of(film), film.cameras);
  Touch touch;
  counts.touch(film.frames.back().frames, touch);
  ASSERT_EQ(touch.finger_count, 1U);
  StageSetting setting = holding();
  setting.parameters.min_points = touch.fingers[0].contact_count * 3 / 2;
  EXPECT_EQ(ids_in(film, setting).back().size(), 1U);
  setting.hysteresis = Hysteresis::off;
  EXPECT_EQ(ids_in(film, setting).front().size(), 1U);
  EXPECT_EQ(ids_in(film, setting).back().size(), 0U);
  // A new finger needs all of them.
  HandFilm late = film;
  late.frames.erase(late.frames.begin(), late.frames.begin() + 4);
  setting.hysteresis = Hysteresis::on;
  EXPECT_EQ(ids_in(late, setting).back().size(), 0U);
}

TEST(KnownFingers, AreToldApartAlthoughTheyAreNarrowTogether) {
  // Two fingers of 14 mm together are 24 mm wide, and one finger may be 25 mm wide.
  const HandFilm film = make_film(fingers_scene(2, 14e-3, 2e-3, 0), {.cameras = 3, .frames = 9});
  EXPECT_EQ(ids_in(film, holding(Hysteresis::off)).back().size(), 1U);
  const auto ids = ids_in(film, holding());
  for (std::size_t k = 4; k < ids.size(); ++k)
    EXPECT_EQ(ids[k].size(), 2U) << k;
  // One finger is not cut.
  const HandFilm one = make_film(fingers_scene(1, 22e-3, 3e-3, 0), {.cameras = 3, .frames = 9});
  for (const auto& frame : ids_in(one, holding()))
    EXPECT_EQ(frame.size(), 1U);
}

TEST(KnownFingers, APalmIsOneAlthoughValleysAreSeenInIt) {
  // Its digits continue it.
  for (const double turn_deg : {-25.0, 20.0}) {
    const HandFilm film = make_film(palpa::test::hand_scene("spread", 11e-3, 92, 35e-3, turn_deg),
                                    {.cameras = 3, .frames = 12, .noise = FilmNoise::full});
    const auto ids = ids_in(film, holding());
    EXPECT_EQ(ids.back().size(), 1U) << turn_deg;
    EXPECT_EQ(changes_in(ids, 6), 0) << turn_deg;
  }
}

/// A finger 2 mm deep that leaves the plate at this speed, from the time `leaving_s` on.
HandFilm leaving(double speed, std::uint64_t seed, double& leaving_s) {
  // The skin leaves at any time between two frames.
  const double begins_s = 0.05 + std::fmod(static_cast<double>(seed) * 0.618034, 1.0) / 90;
  leaving_s = begins_s + 2e-3 / speed;
  return make_film(fingers_scene(1, 18e-3, 2e-3, 30),
                   {.cameras = 1 + static_cast<int>(seed % 3),
                    .frames = static_cast<std::size_t>(leaving_s * 90) + 6,
                    .noise = FilmNoise::full,
                    .seed = seed,
                    .motion = [=](std::size_t, double t) { return Vec3(0, speed * std::max(0.0, t - begins_s), 0); }});
}

TEST(KnownFingers, EndAtOnceWhenTheyLeave) {
  for (const double speed : {0.02, 0.1, 0.3}) {
    for (std::uint64_t seed = 1; seed <= 6; ++seed) {
      double leaving_s = 0, last_s = 0;
      const HandFilm film = leaving(speed, seed, leaving_s);
      const auto ids = ids_in(film, holding());
      for (std::size_t k = 0; k < ids.size(); ++k)
        last_s = ids[k].empty() ? last_s : film.frames[k].time_s;
      EXPECT_GT(last_s, 0.04);
      EXPECT_LE(last_s - leaving_s, 0.01) << speed << " m/s, film " << seed;
    }
  }
}

/// Touches are the same on the device and on the host, and have no contact beyond the shell. Returns how many fingers
/// hold, and how many do not.
std::array<std::uint32_t, 2> expect_same_in_the_shell(const HandFilm& film) {
  Stage host(plate_of(film), film.cameras, holding());
  DeviceStage device(plate_of(film), film.cameras, holding());
  Touch touch, of_device;
  std::array<std::uint32_t, 2> fingers{};
  for (const sensing::FrameSet& set : film.frames) {
    host.touch(set.frames, touch, set.time_s);
    device.touch(set.frames, of_device, set.time_s);
    expect_identical(touch, of_device);
    for (const Contact& contact : touch.contacts) {
      EXPECT_LT(contact.position.y, 0.0F);
      EXPECT_GT(contact.position.y, -1.5e-3F);
      EXPECT_EQ(contact.beyond, 0U);
    }
    for (std::uint32_t f = 0; f < touch.finger_count; ++f) {
      EXPECT_EQ(touch.fingers[f].contact_count, touch.fingers[f].contacts.size());
      ++fingers[touch.fingers[f].holds ? 0 : 1];
    }
  }
  return fingers;
}

TEST(KnownFingers, ReachBeyondTheShellOnTheDeviceAsOnTheHostAndReportNoneOfIt) {
  double leaving_s = 0;
  const auto [held, not_held] = expect_same_in_the_shell(leaving(0.02, 3, leaving_s));
  EXPECT_GE(held, 5U);
  EXPECT_GE(not_held, 1U) << "the finger never falls";
  // It touches the plate's top within the sensor's noise.
  expect_same_in_the_shell(
      make_film(fingers_scene(1, 18e-3, 0.1e-3, 0), {.cameras = 1, .frames = 24, .noise = FilmNoise::full}));
}

TEST(KnownFingers, HoldInRecordingsOfHandsAtRest) {
  PALPA_SHARED_OR_SKIP(folder, "flicker");
  struct Hand {
    const char* name;
    std::filesystem::path scene;
    std::size_t fingers;  ///< at the end
    int flickers;         ///< changes without hysteresis, at least
  };
  for (const Hand& hand :
       {Hand{"one-finger-through-semi-sphere", palpa::test::source_file("assets/semi-sphere.glb"), 1, 0},
        Hand{"two-fingers-touching", folder / "plate.glb", 2, 5}}) {
    const sensing::Recording recording = sensing::load_recording(folder / hand.name);
    std::array<int, 2> changes{};
    for (const Hysteresis hysteresis : {Hysteresis::off, Hysteresis::on}) {
      Stage stage(geometry::make_solids(geometry::load_gltf(hand.scene)), recording.cameras, holding(hysteresis));
      Touch touch;
      sensing::FrameSet set;
      std::uint32_t before = 0;
      for (std::size_t k = 0; k < recording.entries.size(); ++k) {
        read_entry(recording, k, set);
        stage.touch(set.frames, touch, recording.entries[k].time_s);
        changes[hysteresis == Hysteresis::on ? 1 : 0] += k > 0 && touch.finger_count != before ? 1 : 0;
        before = touch.finger_count;
      }
      if (hysteresis == Hysteresis::on) {
        EXPECT_EQ(before, hand.fingers) << hand.name;
      }
    }
    EXPECT_GE(changes[0], hand.flickers) << hand.name;
    EXPECT_LE(changes[1], 1) << hand.name;
  }
}

TEST(KnownFingers, AreForgottenIfTheClockGoesBack) {
  const HandFilm film = make_film(fingers_scene(2, 14e-3, 2e-3, 0), {.frames = 3});
  Stage stage(plate_of(film), film.cameras, holding()), fresh(plate_of(film), film.cameras, holding());
  Touch touch, first;
  stage.touch(film.frames[0].frames, touch, 10);
  stage.touch(film.frames[1].frames, touch, 10.01);
  stage.touch(film.frames[2].frames, touch, 3);
  fresh.touch(film.frames[2].frames, first, 3);
  ASSERT_EQ(touch.finger_count, first.finger_count);
  for (std::uint32_t f = 0; f < first.finger_count; ++f)
    EXPECT_EQ(touch.fingers[f].contacts, first.fingers[f].contacts);
}

/// The share of a film's samples that the frame before also has, at the same pixels.
double share_of_kept_samples(const HandFilm& film) {
  Stage stage(plate_of(film), film.cameras);
  Touch touch;
  std::set<std::uint32_t> before;
  double kept = 0, all = 0;
  for (const sensing::FrameSet& set : film.frames) {
    stage.touch(set.frames, touch, set.time_s);
    std::set<std::uint32_t> now;
    for (std::uint32_t f = 0; f < touch.finger_count; ++f) {
      for (const std::uint32_t i : sample_contacts(touch, touch.fingers[f]))
        now.insert(touch.contacts[i].point);
    }
    for (const std::uint32_t point : now) {
      all += before.empty() ? 0 : 1;
      kept += before.contains(point) ? 1 : 0;
    }
    before = std::move(now);
  }
  return kept / all;
}

TEST(KnownFingers, AtRestKeepMostOfTheirSamples) {
  const HandFilm film = make_film(palpa::test::hand_scene("spread", 11e-3, 92, 35e-3, 20),
                                  {.cameras = 3, .frames = 6, .noise = FilmNoise::full});
  EXPECT_GE(share_of_kept_samples(film), 0.5);
}

TEST(KnownFingers, PartAndMeetIfMostFramesShowIt) {
  constexpr std::uint32_t frame_us = 11111;
  const auto after = [](std::initializer_list<bool> shows) {
    KnownFinger finger;
    for (const bool show : shows) {
      finger.doubt = {.several = show, .apart = show};
      finger.continuation = next_continuation(finger, frame_us);
    }
    return finger.continuation;
  };
  EXPECT_FALSE(may_part(after({true, true}), frame_us));
  EXPECT_TRUE(may_part(after({true, true, true}), frame_us));
  EXPECT_FALSE(may_part(after({true, false, true, false, true}), frame_us)) << "every second frame";
  EXPECT_TRUE(may_part(after({true, true, true, false, true, true}), frame_us)) << "a single frame does not";
  EXPECT_FALSE(may_part(after({}), 33333)) << "one frame alone, at 30 Hz";
  EXPECT_FALSE(may_meet(after({true, true, true}), frame_us));
  EXPECT_TRUE(may_meet(after({true, true, true, false, true, true}), frame_us));
  EXPECT_FALSE(may_meet(after({true, true, true, true, true, true, true, true, true, true, true, true, false, false,
                               false, false, false, false}),
                        frame_us))
      << "it ends";
}

TEST(KnownFingers, RulesAreNumbers) {
  EXPECT_EQ(least_contacts(5, false), 5U);
  EXPECT_EQ(least_contacts(5, true), 3U);
  EXPECT_EQ(least_contacts(0, true), 1U);
  EXPECT_TRUE(small_beside(24, 100, true));
  EXPECT_FALSE(small_beside(25, 100, true));
  EXPECT_TRUE(small_beside(49, 100, false));
  EXPECT_FALSE(small_beside(50, 100, false));
  EXPECT_TRUE(small_alone(9, 5));
  EXPECT_FALSE(small_alone(10, 5));
  EXPECT_TRUE(starves(39, 5));
  EXPECT_FALSE(starves(40, 5));
  EXPECT_FALSE(starves(0, 5));
}

TEST(KnownFingers, FallIfTheyLoseContactsFrameAfterFrame) {
  const auto after = [](std::initializer_list<std::uint32_t> counts) {
    Fall fall{};
    for (const std::uint32_t contacts : counts)
      fall = next_fall(fall, contacts);
    EXPECT_EQ(fall.contacts, counts.end()[-1]);
    return fall;
  };
  EXPECT_EQ(after({100}).from, 0U) << "a new finger";
  EXPECT_EQ(after({100, 88}).from, 0U) << "less than an eighth";
  EXPECT_EQ(after({100, 87}).from, 100U);
  EXPECT_EQ(after({100, 20}).falls, 0U) << "a single frame, as with fewer pixels";
  EXPECT_EQ(after({100, 20, 20}).falls, 0U);
  EXPECT_EQ(after({100, 60, 26}).falls, 0U) << "more than a quarter is left";
  EXPECT_EQ(after({100, 60, 25}).falls, 1U);
  EXPECT_EQ(after({100, 60, 25, 25, 20, 25}).falls, 1U) << "until it has more than a quarter again";
  EXPECT_EQ(after({100, 60, 25, 26}).falls, 0U);
  EXPECT_EQ(after({100, 60, 25, 26}).from, 0U);
  EXPECT_EQ(after({100, 60, 60, 25}).falls, 0U) << "it begins again";
  EXPECT_EQ(after({1000, 800, 600, 400, 300, 250}).falls, 1U);
  EXPECT_EQ(after({0, 0, 0}).falls, 0U);
}

}  // namespace
}  // namespace palpa::touch::test
