// Clicks, stiffness and texture: from the fingers of frames to the gains of slots and to drives.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <optional>
#include <vector>

#include "acoustics/field/pressure.hpp"
#include "fakes.hpp"
#include "geometry/gltf/gltf.hpp"
#include "session/loop/output.hpp"
#include "session/plan/scheduler.hpp"
#include "session/session.hpp"
#include "support/hand_skin.hpp"
#include "support/shared_data.hpp"
#include "support/watched_heap.hpp"

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

  static std::vector<geometry::Solid> made(const std::vector<geometry::Haptics>& haptics) {
    std::vector<geometry::Solid> solids(haptics.size());
    for (std::size_t s = 0; s < solids.size(); ++s) {
      solids[s].name = "solid " + std::to_string(s);
      solids[s].haptics = haptics[s];
    }
    return solids;
  }
  explicit Frames(const std::vector<geometry::Haptics>& haptics, const ScheduleOptions& options = {})
      : solids(made(haptics)), scheduler("scene.glb", solids, {}, options) {
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
  /// The slots of the newest frame, until the next one.
  std::vector<array::SlotFocus> slots() const {
    std::vector<array::SlotFocus> all, foci;
    for (std::uint64_t slot = first_slot() - slots_per_frame; slot < first_slot(); ++slot) {
      array::foci_of_slot(schedule, slot, foci);
      all.insert(all.end(), foci.begin(), foci.end());
    }
    return all;
  }
  /// Plays frames of one finger; the squared gain of each slot.
  template <typename At>
  std::vector<double> forces(std::uint64_t frames, At at) {
    std::vector<double> list;
    for (std::uint64_t frame = 0; frame < frames; ++frame) {
      next({at(frame)});
      for (const array::SlotFocus& focus : slots())
        list.push_back(std::pow(double{focus.gain}, 2));
    }
    return list;
  }
  bool is_clicking() const { return schedule.voices[0].foci.size() == 1; }
};

double line(std::span<const double> slots, double hz) {
  std::complex<double> sum = 0;
  for (std::size_t slot = 0; slot < slots.size(); ++slot)
    sum += std::polar(slots[slot], -2 * std::numbers::pi * hz * slot_s * static_cast<double>(slot));
  return 2 * std::abs(sum) / static_cast<double>(slots.size());
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
  const auto depth = [](std::uint64_t frame) {
    return Tip{.depth_m = frame < 5 ? 0.001F : frame < 10 ? 0.009F : 0.003F};
  };
  const std::vector<double> forces = frames.forces(15, depth);
  double steepest = 0;
  for (std::size_t slot = 1; slot < forces.size(); ++slot)
    steepest = std::max(steepest, std::abs(forces[slot] - forces[slot - 1]));
  EXPECT_NEAR(steepest, 0.8 / slots_per_frame, 1e-4) << "a jump of 0.8 in even steps over a frame";
  EXPECT_NEAR(forces[3], 0.1, 1e-4);
  EXPECT_NEAR(forces[5 * slots_per_frame], 0.1, 1e-4) << "one frame late";
  EXPECT_NEAR(forces[6 * slots_per_frame], 0.9, 1e-4);
  EXPECT_NEAR(forces.back(), 0.3, 1e-4);
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
    for (const array::SlotFocus& focus : frames.slots())
      EXPECT_LE(focus.gain, frames.is_clicking() ? 1.0F : 0.5F);
  }
  // 45 ms are 30 slots; with those of the frame in which they end, five frames.
  EXPECT_EQ(clicking, (std::vector<std::uint64_t>{10, 11, 12, 13, 14, 40, 41, 42, 43, 44}));
  for (const array::SlotFocus& focus : frames.slots())
    EXPECT_EQ(focus.gain, 0.5F) << "the ring is back";
}

TEST(Feel, AClickIsOneFocusAtTheCentroidWithItsFrequency) {
  for (const double hz : {150.0, 175.0, 200.0}) {
    geometry::Haptics haptics = button();
    haptics.click = geometry::Click{0.06, hz};
    Frames frames({haptics});
    const Vec3 centroid(0.01, 0, 0.02);
    frames.next({{.centroid = centroid}});
    std::vector<double> forces;
    for (int frame = 0; frame < 6; ++frame) {
      frames.next({{.depth_m = 0.004F, .centroid = centroid}});
      for (const array::SlotFocus& focus : frames.slots()) {
        EXPECT_LT(glm::distance(focus.position, centroid), 1e-8);
        forces.push_back(std::pow(double{focus.gain}, 2));
      }
    }
    ASSERT_GE(forces.size(), 42U);
    EXPECT_TRUE(std::all_of(forces.begin() + 40, forces.end(), [](double force) { return force == 0; }))
        << "60 ms are 40 slots";
    const std::span burst = std::span<const double>(forces).first(40);
    EXPECT_NEAR(line(burst, hz), 0.5, 0.06) << hz;
    for (const double other : {50.0, 100.0, 250.0, 300.0})
      EXPECT_LT(line(burst, other), 0.2) << hz;
    frames.next({{.depth_m = 0.004F, .centroid = centroid}});
    EXPECT_FALSE(frames.is_clicking());
  }
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
    frames.next({{.depth_m = 0.004F}});
    std::vector<float> gains;
    for (int frame = 0; frame < 3; ++frame) {
      for (const array::SlotFocus& focus : frames.slots())
        gains.push_back(focus.gain);
      frames.next({{.depth_m = 0.004F}});
    }
    EXPECT_EQ(std::all_of(gains.begin(), gains.begin() + 13, [](float gain) { return gain == 0; }), !headroom)
        << "20 ms are 13 slots";
    EXPECT_GT(*std::max_element(gains.begin() + 13, gains.end()), 0.8F);
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
    EXPECT_NEAR(frames.schedule.voices[1].gain, std::sqrt(0.2 / 1.8), 1e-6);
  }
}

/// 29 frames are 203 slots; the last 200 are whole periods of both vibrations.
std::vector<double> sliding(const geometry::Haptics& haptics, double speed_m_s) {
  Frames frames({haptics});
  const auto at = [&](std::uint64_t frame) {
    return Tip{.centroid = Vec3(0.01 + speed_m_s * frame_s * static_cast<double>(frame), 0, 0.02)};
  };
  const std::vector<double> forces = frames.forces(20 + 29, at);  // the velocity is known after 20
  return {forces.end() - 200, forces.end()};
}

TEST(Feel, ATextureVibratesWithTheSpeedOfTheFinger) {
  const std::vector<double> rest = sliding(plate(), 0), slow = sliding(plate(), 0.005), fast = sliding(plate(), 0.05);
  for (const double hz : {30.0, 150.0}) {
    EXPECT_LT(line(rest, hz), 1e-6) << hz;
    EXPECT_GT(line(fast, hz), 0.02) << hz;
    EXPECT_NEAR(line(slow, hz) / line(fast, hz), 0.5, 0.2) << "5 mm/s is half way down, " << hz;
  }
  for (const double force : rest)
    EXPECT_NEAR(force, 0.2 / 1.8, 1e-6);
  for (const double force : fast)
    EXPECT_TRUE(force >= 0 && force <= 1);
}

TEST(Feel, FineGrainsSpreadTheLinesOfAFasterFinger) {
  const auto beside = [](double grain_m, double speed_m_s) {
    const std::vector<double> slots = sliding(plate(grain_m), speed_m_s);
    double sum = 0;
    for (const int periods : {6, 7, 8, 10, 11, 12, 42, 43, 44, 46, 47, 48})
      sum += line(slots, periods / 0.3);
    return sum;
  };
  EXPECT_GT(beside(0.002, 0.05), 5 * beside(0.1, 0.05));
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
  Frames frames({plate(0.002)});
  for (int frame = 0; frame < 9; ++frame)
    frames.next({{.centroid = {0.001 * frame, 0.15, 0}}});
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

TEST(FeelDrives, FingersThatDifferAreSummedInEachSlot) {
  Frames frames({plate(0.002), {}});
  for (int frame = 0; frame < 9; ++frame)
    frames.next({{.centroid = {0.001 * frame, 0.15, 0}}, {.centroid = {0.06, 0.15, 0}, .id = 2, .solid = 1}});
  Drives drives(frames.schedule);
  EXPECT_EQ(drives.plan.cycle.plays, Plays::slot_by_slot);
  std::vector<array::SlotFocus> foci;
  for (const std::uint64_t slot : {frames.first_slot(), frames.first_slot() + 13}) {
    array::foci_of_slot(frames.schedule, slot, foci);
    ASSERT_EQ(foci.size(), 2U);
    EXPECT_LT(foci[0].gain, foci[1].gain);
    const array::Drive expected = array::drive_for(drives.layout, foci), got = drives.at(slot);
    for (std::size_t t = 0; t < got.size(); ++t)
      EXPECT_EQ(got[t].amplitude, expected[t].amplitude);
  }
}

TEST(FeelDrives, AnOwnSolverListsEachSlotWithItsGains) {
  Frames frames({plate(0.002), {}});
  for (int frame = 0; frame < 9; ++frame)
    frames.next({{.centroid = {0.001 * frame, 0.15, 0}}, {.centroid = {0.06, 0.15, 0}, .id = 2, .solid = 1}});
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

/// The radiation pressure, relative to the loudest, at one point in every slot of a finger that presses the button.
std::vector<double> heard_at_the_button(double intensity, std::uint64_t frames) {
  auto solids = geometry::make_solids(geometry::load_gltf(test::source_file("assets/button-and-knob.glb")));
  solids[0].haptics = button(intensity);
  array::Layout layout = array::load_layout("openmpd");
  layout = transformed(layout, layout.default_T_world_layout);
  Session session({.solids = solids, .layout = layout, .events = std::nullopt});
  const OutputSetting output{layout, {}, slot_s, 0.1};
  SlotScratch scratch;
  std::vector<double> heard;
  Vec3 skin(0);
  for (std::uint64_t frame = 0; frame < frames; ++frame) {
    std::vector<glm::vec3> points;
    for (const Vec3& p : test::finger_skin().mesh.positions)
      points.emplace_back(p + Vec3(0, frame < 10 ? -0.002 : -0.004, 0));
    const touch::Touch& touch = session.touch(points, frame_s * static_cast<double>(frame), slots_per_frame * frame);
    EXPECT_EQ(touch.finger_count, 1U);
    EXPECT_NEAR(touch.fingers[0].depth_m, frame < 10 ? 0.002 : 0.004, 2e-4) << "the depth without events";
    skin = Vec3(touch.fingers[0].section.centroid);
    for (std::uint64_t slot = slots_per_frame * frame; slot < slots_per_frame * (frame + 1); ++slot) {
      const auto drive = drive_of_slot(session.plan(), slot, frame_s * static_cast<double>(frame), output, scratch);
      heard.push_back(std::norm(acoustics::pressure_at(layout, drive, skin, {}, array::Directivity::t4010a1)));
    }
  }
  const double loudest = *std::ranges::max_element(heard);
  for (double& value : heard)
    value /= loudest;
  return heard;
}

TEST(FeelDrives, SkinHearsTheClickInTheDrivesOfASession) {
  const std::vector<double> heard = heard_at_the_button(0.5, 20);
  const std::span slots(heard);
  const std::span ring = slots.subspan(30, 30), burst = slots.subspan(10 * slots_per_frame, 30);
  EXPECT_GT(line(burst, 200), 0.4);
  EXPECT_GT(line(burst, 200), 4 * line(ring, 200));
  for (const int periods : {3, 6, 12})  // in 45 ms; 200 Hz has 9
    EXPECT_LT(line(burst, periods / 0.045), 0.2 * line(burst, 200)) << periods;
  const std::vector<double> again = heard_at_the_button(0.5, 20);
  EXPECT_EQ(heard, again) << "the same input gives the same drives";
  for (std::uint64_t slot = 100; slot < 105; ++slot)
    EXPECT_EQ(slots[slot], 0) << "the rest of the frame in which the burst ends, " << slot;
}

}  // namespace
}  // namespace palpa::session
