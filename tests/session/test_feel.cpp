// Clicks, stiffness and texture: from the fingers of frames to the gains of slots and to drives.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "array/drive.hpp"
#include "fakes.hpp"
#include "session/loop/output.hpp"
#include "session/plan/scheduler.hpp"
#include "session/session.hpp"
#include "support/watched_heap.hpp"
#include "touched_scene.hpp"

namespace palpa::session {
namespace {

constexpr double slot_s = 1.5e-3;
constexpr std::uint64_t slots_per_frame = 7;
constexpr double frame_s = slots_per_frame * slot_s;

geometry::Haptics button(double intensity = 0.5) {
  geometry::Haptics haptics;
  haptics.intensity = intensity;
  haptics.press_depth_m = 0.003;
  haptics.click.emplace();
  return haptics;
}
geometry::Haptics spring() {
  geometry::Haptics haptics;
  haptics.stiffness = std::vector<geometry::DepthForce>{{0, 0}, {0.01, 1}};
  return haptics;
}
geometry::Haptics plate(double grain_m = 0.1) {
  geometry::Haptics haptics;
  haptics.texture = {0.2, 1, 0.6};
  haptics.grain_m = grain_m;
  return haptics;
}

struct Tip {
  float depth_m = 0.001F;
  Vec3 centroid{0.01, 0, 0.02};
  std::uint32_t id = 1, solid = 0;
};

/// A stage made of numbers: frames of fingers in, the gains of their slots out.
struct Frames {
  std::vector<geometry::Solid> solids;
  Scheduler scheduler;
  array::Schedule schedule;
  std::uint64_t count = 0;
  bool knows_slots = true;

  explicit Frames(const std::vector<geometry::Haptics>& haptics, const ScheduleOptions& options = {})
      : solids(test::solids_with(haptics)), scheduler("scene.glb", solids, {}, options) {
    array::reserve(schedule, touch::max_fingers, touch::max_foci);
  }

  static touch::Touch touch(const std::vector<Tip>& tips) {
    touch::Touch touch;
    for (const Tip& tip : tips) {
      touch::Finger finger;
      finger.id = tip.id;
      finger.solid = tip.solid;
      finger.depth_m = tip.depth_m;
      finger.section.centroid = glm::vec3(tip.centroid);
      for (int n = 0; n < 10; ++n) {
        const double angle = 0.2 * std::numbers::pi * n;
        finger.foci.push_back({glm::vec3(tip.centroid + 0.005 * Vec3(std::cos(angle), 0, std::sin(angle))), 7});
      }
      touch.fingers.push_back(finger);
    }
    touch.finger_count = static_cast<std::uint32_t>(tips.size());
    return touch;
  }
  std::uint64_t first_slot() const { return 1000 + slots_per_frame * count; }
  const array::Schedule& next(const std::vector<Tip>& tips, bool follows = true) {
    const double time_s = 5 + frame_s * static_cast<double>(count);
    const std::optional<std::uint64_t> first = knows_slots ? std::optional(first_slot()) : std::nullopt;
    scheduler.make(touch(tips), time_s, schedule, {follows, first});
    ++count;
    return schedule;
  }
  bool is_clicking() const { return schedule.voices[0].foci.size() == 1; }
};

/// A slot lasts at most 0.4 of a vibration's period: 2 ms of 200 Hz, 2.67 ms of 150 Hz, 13.3 ms of 30 Hz.
TEST(Feel, VibrationsForWhichSlotsAreTooLongAreNotPlayed) {
  geometry::Haptics coarse = plate();
  coarse.texture = {0.2, 1, 0};
  const struct {
    double dwell_s;
    bool steady, clicks, is_fine, is_coarse;
  } cases[] = {{2e-3, false, true, true, true},     {2.01e-3, false, false, true, true},
               {2.66e-3, false, false, true, true}, {2.67e-3, false, false, false, true},
               {12e-3, false, false, false, true},  {13.4e-3, false, false, false, false},
               {1.5e-3, true, false, false, false}};
  for (const auto& [dwell_s, steady, clicks, is_fine, is_coarse] : cases) {
    Frames frames({button(), plate(), coarse}, {.voice = {.dwell_s = dwell_s}, .steady = steady});
    const auto at = [](int frame) { return Vec3(0.01 + 0.002 * frame, 0, 0.02); };  // textures need motion
    for (int frame = 0; frame < 4; ++frame) {
      frames.next({{.depth_m = frame < 3 ? 0.001F : 0.004F},
                   {.centroid = at(frame), .id = 2, .solid = 1},
                   {.centroid = at(frame), .id = 3, .solid = 2}});
    }
    EXPECT_EQ(frames.is_clicking(), clicks) << dwell_s;
    EXPECT_EQ(frames.schedule.voices[1].course.changes(), is_fine) << dwell_s;
    EXPECT_EQ(frames.schedule.voices[2].course.changes(), is_coarse) << dwell_s;
    // Other programs' messages as well.
    Frames later({{}, {}}, {.voice = {.dwell_s = dwell_s}, .steady = steady});
    later.scheduler.change_feel(1, {.texture = array::Texture{0.2, 1, 0.6}});
    for (int frame = 0; frame < 4; ++frame)
      later.next({{}, {.centroid = at(frame), .id = 2, .solid = 1}});
    EXPECT_EQ(later.schedule.voices[1].course.changes(), is_fine) << dwell_s;
  }
}

TEST(Feel, StiffnessIsTheForceAtTheDepth) {
  EXPECT_EQ(geometry::force_at({}, 0.01), 1);
  const std::vector<geometry::DepthForce> table{{0.001, 0.2}, {0.002, 0.4}, {0.004, 1}};
  EXPECT_EQ(geometry::force_at(table, 0), 0.2);
  EXPECT_NEAR(geometry::force_at(table, 0.0015), 0.3, 1e-12);
  EXPECT_NEAR(geometry::force_at(table, 0.003), 0.7, 1e-12);
  EXPECT_EQ(geometry::force_at(table, 0.1), 1);
  geometry::Haptics soft = spring();
  soft.intensity = 0.5;
  Frames frames({soft});
  frames.next({{.depth_m = 0.0025F}}, false);
  EXPECT_NEAR(frames.schedule.voices[0].gain, 0.25, 1e-6) << "half of a quarter's square root";
  EXPECT_FALSE(frames.schedule.voices[0].course.changes()) << "a frame by itself has one gain";
}

TEST(Feel, StiffnessGoesFromFrameToFrameInEvenSteps) {
  Frames frames({spring()});
  double before = 0.1;
  for (int frame = 0; frame < 15; ++frame) {
    const double force = frame < 5 ? 0.1 : frame < 10 ? 0.9 : 0.3;
    const std::uint64_t first = frames.first_slot();
    const array::Voice& voice = frames.next({{.depth_m = static_cast<float>(0.01 * force)}}).voices[0];
    for (std::uint64_t n = 0; n <= slots_per_frame; ++n) {
      const double played = std::pow(voice.gain * array::modulate(voice.course, first + n, slot_s), 2);
      EXPECT_NEAR(played, before + (force - before) * static_cast<double>(n) / slots_per_frame, 1e-4) << frame;
    }
    before = force;
  }
}

TEST(Feel, AButtonClicksWhenItIsPressedAndWhenItNoLongerIs) {
  Frames frames({button()});
  const auto depth_of = [](std::uint64_t frame) {
    // Pressed in frame 10, up to 90 % in frame 30, and up to 70 % in frame 40.
    return frame < 10 ? 0.001F : frame < 30 ? 0.0035F : frame < 40 ? 0.0027F : 0.0021F;
  };
  std::vector<std::uint64_t> clicking;
  for (std::uint64_t frame = 0; frame < 60; ++frame) {
    frames.next({{.depth_m = depth_of(frame)}});
    if (frames.is_clicking()) clicking.push_back(frame);
    EXPECT_EQ(frames.schedule.voices[0].gain, frames.is_clicking() ? 1 : 0.5);
  }
  // 45 ms are 30 slots; with those of the frame in which they end, five frames.
  EXPECT_EQ(clicking, (std::vector<std::uint64_t>{10, 11, 12, 13, 14, 40, 41, 42, 43, 44}));
}

TEST(Feel, AClickIsOneFocusAtTheCentroidWithItsFrequency) {
  geometry::Haptics haptics = button();
  haptics.click = geometry::Click{0.06, 150};
  Frames frames({haptics});
  const Vec3 centroid(0.01, 0, 0.02);
  frames.next({{.centroid = centroid}});
  const std::uint64_t pressed = frames.first_slot();
  for (int frame = 0; frame < 6; ++frame) {
    const array::Voice& voice = frames.next({{.depth_m = 0.004F, .centroid = centroid}}).voices[0];
    ASSERT_TRUE(frames.is_clicking());
    EXPECT_LT(glm::distance(voice.foci[0], centroid), 1e-8);
    EXPECT_EQ(voice.modulation_hz, 150);
    EXPECT_EQ(voice.course.begin_slot, pressed);
    EXPECT_EQ(voice.course.end_slot, pressed + 40) << "60 ms";
  }
  frames.next({{.depth_m = 0.004F, .centroid = centroid}});
  EXPECT_FALSE(frames.is_clicking());
}

TEST(Feel, ClicksNoMoreThanOnceInATenthOfASecond) {
  Frames frames({button()});
  std::size_t begun = 0;
  bool before = false;
  // Pressed and released in every frame, for a second and a half.
  for (std::uint64_t frame = 0; frame < 143; ++frame) {
    frames.next({{.depth_m = frame % 2 == 0 ? 0.001F : 0.004F}});
    begun += frames.is_clicking() && !before ? 1 : 0;
    before = frames.is_clicking();
  }
  EXPECT_GE(begun, 12U);
  EXPECT_LE(begun, 15U);
}

TEST(Feel, SilenceComesFirstWithoutHeadroom) {
  EXPECT_EQ(resting_gain(button(0.8), 1), 0.8);
  geometry::Haptics soft = button(1);
  soft.stiffness = std::vector<geometry::DepthForce>{{0.003, 0.25}};
  EXPECT_EQ(resting_gain(soft, 1), 0.5);
  geometry::Haptics open = button();
  open.intensity.reset();
  EXPECT_EQ(resting_gain(open, 0.4), 0.4);
  for (const bool headroom : {true, false}) {
    Frames frames({button(headroom ? 0.5 : 1)});
    frames.next({Tip{}});
    const std::uint64_t pressed = frames.first_slot();
    const array::Voice& voice = frames.next({{.depth_m = 0.004F}}).voices[0];
    EXPECT_EQ(voice.course.begin_slot, pressed + (headroom ? 0 : 13)) << "20 ms";
    EXPECT_EQ(voice.course.end_slot - voice.course.begin_slot, 30U) << "45 ms";
    EXPECT_EQ(voice.gain, 1);
  }
}

TEST(Feel, ChangesWithTheFrameIfSlotsAreUnknown) {
  Frames frames({button(), spring()});
  frames.knows_slots = false;
  frames.next({{.depth_m = 0.001F}, {.depth_m = 0.001F, .id = 2, .solid = 1}});
  frames.next({{.depth_m = 0.004F}, {.depth_m = 0.009F, .id = 2, .solid = 1}});
  EXPECT_TRUE(frames.is_clicking());
  EXPECT_FALSE(array::changes(frames.schedule));
  EXPECT_EQ(frames.schedule.voices[0].modulation_hz, 200);
  EXPECT_NEAR(frames.schedule.voices[1].gain, std::sqrt(0.9), 1e-6);
  int clicking = 0;
  for (int frame = 0; frame < 9; ++frame) {
    clicking += frames.is_clicking() ? 1 : 0;
    frames.next({{.depth_m = 0.004F}});
  }
  EXPECT_EQ(clicking, 5) << "45 ms of frames";
}

TEST(Feel, AVibrationBesideAForceLeavesTheForceToTheGain) {
  geometry::Haptics both = spring();
  both.texture = plate().texture;
  Frames frames({both});
  frames.knows_slots = false;
  for (int n = 0; n < 5; ++n)
    frames.next({{.depth_m = 0.0025F, .centroid{0.002 * n, 0, 0}}});
  const array::Voice& voice = frames.schedule.voices[0];
  EXPECT_TRUE(voice.course.changes());
  EXPECT_NEAR(voice.gain, 0.5, 1e-6);
  EXPECT_EQ(voice.course.to.force, 1);
}

TEST(Feel, NothingClicksOrVibratesForALinkThatIsTooSlow) {
  Frames frames({button(), plate()}, {.steady = true});
  for (int frame = 0; frame < 9; ++frame) {
    frames.next({{.depth_m = frame < 3 ? 0.001F : 0.004F}, {.centroid = {0.001 * frame, 0, 0}, .id = 2, .solid = 1}});
    EXPECT_FALSE(frames.is_clicking());
    EXPECT_FALSE(array::changes(frames.schedule));
    EXPECT_EQ(frames.schedule.voices[1].gain, 1) << "as without a texture";
  }
}

TEST(Feel, ATextureVibratesWithTheSpeedOfTheFingerAndThePlaceInGrains) {
  constexpr double grain_m = 0.002;
  for (const auto& [speed_m_s, motion] : {std::pair(0.0, 0.0), {0.005, 0.5}, {0.05, 1.0}}) {
    Frames frames({plate(grain_m)});
    Vec3 place;
    for (int frame = 0; frame < 20; ++frame) {  // then the velocity is known
      place = {0.01 + speed_m_s * frame_s * frame, 0, 0.02};
      frames.next({{.centroid = place}});
    }
    const array::Voice& voice = frames.schedule.voices[0];
    EXPECT_NEAR(voice.course.to.motion, motion, 0.01) << speed_m_s;
    if (speed_m_s == 0) {
      EXPECT_FALSE(voice.course.changes()) << "at rest";
      EXPECT_NEAR(voice.gain, std::sqrt(0.2 / 1.8), 1e-6);
      continue;
    }
    EXPECT_EQ(voice.course.texture, (array::Texture{0.2, 1, 0.6}));
    EXPECT_LT(glm::distance(voice.course.to.place, place / grain_m), 1e-4);
    EXPECT_NEAR(voice.course.to.place.x - voice.course.from.place.x, speed_m_s * frame_s / grain_m, 1e-4);
    EXPECT_EQ(voice.course.slots, slots_per_frame);
  }
}

TEST(Feel, ATextureMovesWithItsSolid) {
  Frames frames({plate()});
  for (int frame = 0; frame < 20; ++frame) {
    Transform pose(1);
    pose[3] = Vec4(0.001 * frame, 0, 0, 1);
    frames.scheduler.set_pose(0, pose);
    frames.next({{.centroid = {0.001 * frame, 0, 0}}});
  }
  EXPECT_LT(frames.schedule.voices[0].course.to.motion, 1e-6) << "the finger rests on a solid that moves";
}

TEST(Feel, MayChangeWhileItPlays) {
  geometry::Haptics plain;
  plain.press_depth_m = 0.003;
  Frames frames({plain});
  const auto change = [&](const FeelChange& to) {
    EXPECT_EQ(test::allocations_of([&] { frames.scheduler.change_feel(0, to); }), 0U);
  };
  frames.next({{.depth_m = 0.004F}});
  change({.click = geometry::Click()});
  frames.next({{.depth_m = 0.004F}});
  EXPECT_FALSE(frames.is_clicking()) << "it pressed before";
  frames.next({{.depth_m = 0.001F}});
  EXPECT_TRUE(frames.is_clicking());
  Stiffness soft;
  soft.push_back({0, 0.25});
  change({.click = geometry::Click{.burst_s = 0}, .stiffness = soft});
  frames.next({{.depth_m = 0.001F}});
  EXPECT_FALSE(frames.is_clicking());
  EXPECT_TRUE(frames.schedule.voices[0].course.changes()) << "in even steps";
  frames.next({{.depth_m = 0.001F}});
  EXPECT_EQ(frames.schedule.voices[0].gain, 0.5);
}

TEST(Feel, OfOneFingerIsNotThatOfTheNext) {
  Frames frames({plate(0.002), {}});
  for (int frame = 0; frame < 9; ++frame)
    frames.next({{.centroid = {0.001 * frame, 0, 0}}, {.id = 2, .solid = 1}});
  EXPECT_TRUE(frames.schedule.voices[0].course.changes());
  frames.next({{.id = 2, .solid = 1}});
  EXPECT_EQ(frames.schedule.voices[0].course, array::Course()) << "its voice is in the place of another's";
}

TEST(Feel, LeavesOtherSolidsAsTheyAreAndAllocatesNothing) {
  geometry::Haptics quiet;
  quiet.intensity = 0.7;
  quiet.press_depth_m = 0.003;
  Frames frames({quiet, button(), plate(0.002)});
  const auto tips = [](int frame) {
    const float depth = frame % 20 < 10 ? 0.001F : 0.004F;
    return std::vector<Tip>{{.depth_m = depth},
                            {.depth_m = depth, .id = 2, .solid = 1},
                            {.centroid = {0.002 * frame, 0, 0}, .id = 3, .solid = 2}};
  };
  for (int frame = 0; frame < 40; ++frame) {
    const touch::Touch touch = Frames::touch(tips(frame));
    const Following following{true, 1000 + slots_per_frame * static_cast<std::uint64_t>(frame)};
    const std::size_t allocations =
        test::allocations_of([&] { frames.scheduler.make(touch, frame_s * frame, frames.schedule, following); });
    EXPECT_EQ(allocations, 0U) << frame;
    const array::Voice& voice = frames.schedule.voices[0];
    EXPECT_EQ(voice.gain, 0.7);
    EXPECT_EQ(voice.course, array::Course());
    EXPECT_EQ(voice.foci.size(), 10U);
  }
}

// ---- drives ---------------------------------------------------------------------------------------------------------

/// Nine frames of a finger that slides on a texture and, if `other`, one that rests on another solid.
Frames sliding_frames(bool other) {
  Frames frames({plate(0.002), {}});
  for (int frame = 0; frame < 9; ++frame) {
    std::vector<Tip> tips{{.centroid = {0.001 * frame, 0.15, 0}}};
    if (other) tips.push_back({.centroid = {0.06, 0.15, 0}, .id = 2, .solid = 1});
    frames.next(tips);
  }
  return frames;
}

struct Drives {
  array::Layout layout = test::small_layout();
  OutputSetting setting{layout, {}, slot_s, 0.1};
  Plan plan{};

  explicit Drives(const array::Schedule& schedule) {
    plan.schedule = schedule;
    test::list_drives(layout, plan);
  }
  array::Drive at(std::uint64_t slot) {
    SlotScratch scratch;
    const auto drive = drive_of_slot(plan, slot, 0, setting, scratch);
    return {drive.begin(), drive.end()};
  }
};

TEST(FeelDrives, GainsThatAllFingersShareScaleTheListedDrives) {
  const Frames frames = sliding_frames(false);
  Drives drives(frames.schedule);
  EXPECT_EQ(drives.plan.cycle.length, 10U) << "the ring is listed once";
  EXPECT_TRUE(drives.plan.course.changes());
  std::vector<array::SlotFocus> foci;
  for (std::uint64_t slot = frames.first_slot(); slot < frames.first_slot() + 20; ++slot) {
    array::foci_of_slot(frames.schedule, slot, foci);
    const array::Drive expected = array::drive_for(drives.layout, foci), got = drives.at(slot);
    for (std::size_t t = 0; t < got.size(); ++t) {
      EXPECT_NEAR(got[t].amplitude, expected[t].amplitude, 1e-6);
      EXPECT_EQ(got[t].phase, expected[t].phase);
    }
  }
  const PlayedPlan link = played(drives.plan, drives.layout.transducers.size(), frames.first_slot(), 2000);
  EXPECT_EQ(link.slots.cycle.plays, Plays::slot_by_slot) << "a board with its own clock gets drives one by one";
  EXPECT_TRUE(link.drives.empty());
}

TEST(FeelDrives, AnOwnSolverListsEachSlotWithItsGains) {
  const Frames frames = sliding_frames(true);
  Drives drives(frames.schedule);
  SlotWork work;
  drive_by_own(
      drives.plan, drives.layout, {},
      [](const auto&, const auto&, std::span<const array::SlotFocus> foci, std::span<array::TransducerDrive> out) {
        std::ranges::fill(out, array::TransducerDrive{foci[0].gain, 0});
      },
      work);
  EXPECT_EQ(drives.plan.cycle.length, most_cycle);
  std::vector<array::SlotFocus> foci;
  const std::uint64_t first = array::first_changing_slot(frames.schedule);
  for (std::uint64_t slot = first; slot < first + most_cycle; ++slot) {
    array::foci_of_slot(frames.schedule, slot, foci);
    EXPECT_EQ(drives.at(slot)[0].amplitude, foci[0].gain) << slot;
  }
}

TEST(FeelDrives, ASessionClicksInTheSlotsThatPlayTheFrame) {
  auto solids = test::asset_solids("button-and-knob");
  solids[0].haptics = button();
  Session session({.solids = solids, .layout = test::posed_openmpd(), .events = std::nullopt});
  for (std::uint64_t frame = 0; frame < 20; ++frame) {
    const double depth_m = frame < 10 ? 0.002 : 0.004;
    const touch::Touch& touch =
        session.touch(test::finger_at({0, -depth_m, 0}), frame_s * static_cast<double>(frame), slots_per_frame * frame);
    ASSERT_EQ(touch.finger_count, 1U);
    EXPECT_NEAR(touch.fingers[0].depth_m, depth_m, 2e-4) << "the depth without events";
    const array::Voice& voice = session.schedule().voices[0];
    const bool clicks = frame >= 10 && frame < 15;
    ASSERT_EQ(voice.foci.size(), clicks ? 1U : 10U) << frame;
    EXPECT_EQ(voice.course.begin_slot, clicks ? 10 * slots_per_frame : 0U);
    const Plan& plan = session.plan();
    EXPECT_EQ(plan.cycle.length, clicks ? 1U : 10U);
    EXPECT_EQ(plan.cycle.modulation_hz, clicks ? 200 : 0);
    EXPECT_EQ(plan.course, voice.course) << "of all fingers, and thus of the listed drives";
  }
}

}  // namespace
}  // namespace palpa::session
