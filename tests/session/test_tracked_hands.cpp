// Hands of a tracker in a session: their skin becomes contacts, fingers and sound like that of cameras.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <glm/common.hpp>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "fakes.hpp"
#include "hand_motion.hpp"
#include "sensing/joints/hand_check.hpp"
#include "sensing/joints/read_frame.hpp"
#include "sensing/joints/tracked_source.hpp"
#include "session/replay.hpp"
#include "session/session.hpp"
#include "support/files.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"
#include "support/tracked_hands.hpp"
#include "touched_scene.hpp"

namespace palpa::session {
namespace {

constexpr double delta_m = 3e-3, tip_radius_m = 7e-3;

/// The cube reaches from -20 to 20 mm, and 40 mm down from y = 0.
double depth_in_cube(const Vec3& p) {
  return std::min({-p.y, p.y + 0.04, 0.02 - std::abs(p.x), 0.02 - std::abs(p.z)});
}

std::vector<sensing::Capsule> bones_of(const std::vector<sensing::TrackedHand>& hands,
                                       const Transform& T_world_joints = Transform(1.0)) {
  std::vector<sensing::Capsule> bones;
  for (const sensing::TrackedHand& hand : hands)
    sensing::append_capsules(hand, T_world_joints, bones);
  return bones;
}

/// A pointing hand whose index fingertip is so deep below y = 0.
sensing::TrackedHand pressing(double depth_m, double x = 0) {
  return test::pointing_hand({x, tip_radius_m - depth_m, 0});
}

/// Each contact is skin of the hand, and as deep as it is.
void expect_contacts(const touch::Touch& touch, const std::vector<sensing::Capsule>& bones) {
  for (const touch::Contact& contact : touch.contacts) {
    const Vec3 place(contact.position);
    EXPECT_NEAR(contact.depth_m, depth_in_cube(place), 1e-6);
    EXPECT_LT(contact.depth_m, delta_m);
    double least = 1;
    for (const sensing::Capsule& bone : bones)
      least = std::min(least, sensing::distance_to(bone, place));
    EXPECT_NEAR(least, 0, 1e-6);
  }
}

struct Tracked : test::OnBackends {
  static SessionSetting setting() {
    SessionSetting setting{.solids = test::asset_solids("cube"), .tracked = true, .layout = test::small_layout()};
    setting.touch.delta_m = delta_m;
    return setting;
  }
};

TEST_P(Tracked, AFingertipIsAFinger) {
  Session session = make(setting());
  EXPECT_EQ(session.touch(bones_of({pressing(-1e-3)}), 0.00, 0).finger_count, 0U);
  const std::vector<sensing::Capsule> bones = bones_of({pressing(2e-3, 4e-3)});
  const touch::Touch& touch = session.touch(bones, 0.01, 7);
  ASSERT_EQ(touch.finger_count, 1U);
  expect_contacts(touch, bones);
  // A ball that is 2 mm deep has a cap of 2 pi r 2 mm, with a point in each square millimetre.
  EXPECT_NEAR(static_cast<double>(touch.contacts.size()), 2 * 3.14159 * 7 * 2, 10);
  EXPECT_LT(glm::distance(touch.fingers[0].section.centroid, glm::vec3(4e-3F, -1e-3F, 0)), 0.5e-3F);
  EXPECT_EQ(session.schedule().voice_count, 1U);
  ASSERT_FALSE(session.events().empty());
  EXPECT_EQ(session.events().front().kind, EventKind::touch);
  EXPECT_EQ(session.touch(std::vector<sensing::Capsule>(), 0.02, 14).finger_count, 0U) << "no hand, no skin";
  EXPECT_EQ(session.schedule().voice_count, 0U);
}

TEST_P(Tracked, OutsideTheRoomThereIsNoSkin) {
  SessionSetting walled = setting();
  walled.surroundings.room = Box{Vec3(-1, -1, -1), Vec3(1, -1.5e-3, 1)};
  Session session = make(std::move(walled));
  const touch::Touch& touch = session.touch(bones_of({pressing(2e-3)}), 0, 0);
  ASSERT_FALSE(touch.contacts.empty());
  for (const touch::Contact& contact : touch.contacts)
    EXPECT_LE(contact.position.y, -1.5e-3F);
}

TEST_P(Tracked, TakesNothingElse) {
  Session session = make(setting());
  EXPECT_ERROR(session.touch(std::vector<glm::vec3>{{0, 0, 0}}, 0), Exit::usage, "takes its frames, not skin points");
  EXPECT_ERROR(session.touch(std::vector<sensing::DepthFrame>(1), 0), Exit::usage, "not depth frames");
  Session points = make({.solids = test::asset_solids("cube")});
  EXPECT_ERROR(points.touch(bones_of({pressing(0)}), 0, 0), Exit::usage, "takes no hands");
}

/// A file with these frames, as a source that gives them as fast as they are taken.
std::unique_ptr<sensing::DepthSource> source_of(const std::string& lines,
                                                const Transform& T_world_joints = Transform(1.0)) {
  const std::filesystem::path file = test::scratch_folder("tracked-hands") / "hands.jsonl";
  test::write_text(file, lines);
  return sensing::make_tracked_source(sensing::open_tracker(file, false), T_world_joints);
}

/// A finger that dips into the cube, and is lost in its middle.
std::string dip(int frames) {
  std::vector<sensing::TrackedFrame> film;
  for (int i = 0; i < frames; ++i) {
    const double part = static_cast<double>(i) / (frames - 1);
    film.push_back({0.01 * i, {pressing(6e-3 * part - 3e-3, 1e-4 * i)}});
  }
  film.push_back({0.01 * frames, {}});
  return test::lines_of(film);
}

TEST_P(Tracked, ARunPlaysItAndEndsInSilence) {
  SessionSetting live = setting();
  live.hold_s = 1;
  Session session = make(std::move(live));
  test::SpyLink link;
  std::atomic<bool> stop{false};
  const auto source = source_of(dip(40));
  const LoopStats stats = session.run(*source, link, stop, {.every_frame = true});
  EXPECT_EQ(stats.captured, 41U);
  EXPECT_EQ(stats.planned, 41U);
  EXPECT_GT(stats.touching, 15U);
  EXPECT_LT(stats.touching, 25U);
  EXPECT_GT(link.most, 0.0F);
  EXPECT_TRUE(link.ended_silent());
}

TEST_P(Tracked, AReplayIsTheSameEachTime) {
  std::vector<std::vector<float>> loudest;
  for (int i = 0; i < 2; ++i) {
    Session session = make(setting());
    test::SpyLink link;
    const std::atomic<bool> stop{false};
    const auto source = source_of(dip(40));
    const ReplayStats stats = replay(session, *source, link, stop);
    EXPECT_EQ(stats.frames, 41U);
    EXPECT_GT(stats.drives, stats.silent_drives);
    EXPECT_TRUE(link.ended_silent());
    loudest.push_back(link.loudest);
  }
  EXPECT_EQ(loudest[0], loudest[1]);
}

/// Turns and moves a hand so that its index finger's last bone points straight down, 2 mm deep into the middle of the
/// cube's top.
Transform pointing_down(const sensing::TrackedHand& hand) {
  const Vec3 tip = hand.joints[sensing::index_tip_joint];
  const Vec3 along = glm::normalize(tip - hand.joints[sensing::index_tip_joint - 1]), down(0, -1, 0);
  const Transform turn = glm::rotate(Transform(1.0), std::acos(std::clamp(glm::dot(along, down), -1.0, 1.0)),
                                     glm::normalize(glm::cross(along, down)));
  const double height_m = hand.radii_m[sensing::index_tip_joint] - 2e-3;
  return glm::translate(Transform(1.0), Vec3(0, height_m, 0)) * turn * glm::translate(Transform(1.0), -tip);
}

TEST_P(Tracked, ARecordedHandTouches) {
  for (const char* name : {"HandSplay-110fps", "pinch", "flapping"}) {
    SCOPED_TRACE(name);
    PALPA_SHARED_OR_SKIP(packed, std::string("hand-motion/") + name + ".leap6.jsonl.gz");
    const std::string lines = test::unpacked(packed);
    const sensing::TrackedFrame first = sensing::read_frame(lines.substr(0, lines.find('\n')), "first").value();
    ASSERT_FALSE(first.hands.empty());
    const Transform T_world_joints = pointing_down(first.hands.front());
    const auto source = source_of(lines, T_world_joints);
    Session session = make(setting());
    sensing::FrameSet set;
    int frames = 0, touching = 0;
    while (source->next(set, 0)) {
      ASSERT_TRUE(set.tracked);
      const touch::Touch& touch = session.touch(set.capsules, set.time_s, static_cast<std::uint64_t>(7 * frames));
      expect_contacts(touch, set.capsules);
      if (frames == 0) {
        const auto in_the_middle = [](const touch::Finger& finger) {
          return glm::distance(finger.section.centroid, glm::vec3(0, -1e-3F, 0)) < 2e-3F;
        };
        EXPECT_TRUE(std::ranges::any_of(std::span(touch.fingers).first(touch.finger_count), in_the_middle));
      }
      touching += touch.finger_count > 0 ? 1 : 0;
      ++frames;
    }
    EXPECT_GT(frames, 280);
    EXPECT_GE(touching, 3);
  }
}

TEST(Recordings, OfRealHandsLoseNoFrameThatIsRight) {
  // Frames, hands, and those left out because a joint moved faster than 5 m/s.
  struct Row {
    const char* name;
    std::size_t frames, hands, jumps;
  };
  for (const Row& row : {Row{"HandSplay-110fps", 288, 288, 0},
                         {"Waiting-110fps", 326, 326, 0},
                         {"brian", 500, 500, 0},
                         {"flapping", 328, 656, 0},
                         {"grab", 374, 374, 0},
                         {"pinch", 307, 307, 0},
                         {"rollAndPitchWithEntry", 808, 808, 0},
                         {"test-paddle-rightwards", 367, 367, 1},
                         {"wave", 111, 111, 0}}) {
    SCOPED_TRACE(row.name);
    PALPA_SHARED_OR_SKIP(packed, std::string("hand-motion/") + row.name + ".leap6.jsonl.gz");
    std::istringstream lines(test::unpacked(packed));
    sensing::HandCheck check;
    Row found{row.name, 0, 0, 0};
    for (std::string line; std::getline(lines, line);) {
      std::optional<sensing::TrackedFrame> frame = sensing::read_frame(line, "line");
      if (!frame) continue;
      ++found.frames;
      found.hands += frame->hands.size();
      const auto doubt = check.check(*frame, frame->time_s);
      found.jumps += doubt == sensing::HandDoubt::jump ? 1 : 0;
      EXPECT_TRUE(!doubt || doubt == sensing::HandDoubt::jump) << to_text(*doubt) << ", frame " << found.frames;
    }
    EXPECT_EQ(found.frames, row.frames);
    EXPECT_EQ(found.hands, row.hands);
    EXPECT_EQ(found.jumps, row.jumps);
  }
}

INSTANTIATE_TEST_SUITE_P(Backends, Tracked, testing::Bool(), test::backend_name);

}  // namespace
}  // namespace palpa::session
