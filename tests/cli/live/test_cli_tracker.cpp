// Hands from a tracker on the command line: runs, exports, and the registration of the tracker.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "array/layouts/layout.hpp"
#include "cli/support/heard_drives.hpp"
#include "cli/support/here.hpp"
#include "cli/support/process.hpp"
#include "sensing/joints/hand_pose.hpp"
#include "sensing/rig.hpp"
#include "setup/tasks/register_tracker.hpp"
#include "support/files.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"
#include "support/tracked_hands.hpp"

namespace palpa::test {
namespace {

using nlohmann::json;

constexpr double tip_radius_m = 7e-3;

/// The tracker's own axes are not the world's.
Transform true_pose() {
  return glm::translate(Transform(1.0), Vec3(0.1, -0.2, 0.05)) *
         glm::rotate(Transform(1.0), 0.7, glm::normalize(Vec3(1, 2, -1)));
}

class Tracker : public testing::Test {
 protected:
  Tracker() {
    sensing::Rig rig = sensing::load_rig(source_file("tests/cli/support/small_rig.toml"));
    rig.T_world_joints = true_pose();
    write_text(file("rig.toml"), sensing::to_toml(rig));
    write_text(file("dip.jsonl"), lines_of(dip(Transform(1.0))));
    write_text(file("posed.jsonl"), lines_of(dip(glm::inverse(true_pose()))));
  }
  std::string file(const std::string& name) const { return (folder_ / name).string(); }

  /// A hand in the world, as a tracker with that pose sees it.
  static sensing::TrackedHand seen(const Transform& T_joints_world, sensing::TrackedHand hand) {
    for (Vec3& joint : hand.joints)
      joint = transform_point(T_joints_world, joint);
    return hand;
  }
  /// A fingertip that gets 2.5 mm into the cube's top.
  static std::vector<sensing::TrackedFrame> dip(const Transform& T_joints_world) {
    std::vector<sensing::TrackedFrame> film;
    for (int i = 0; i < 30; ++i) {
      const double depth_m = 2.5e-3 * std::sin(0.1 * i);
      film.push_back({0.01 * i, {seen(T_joints_world, pointing_hand({1e-5 * i, tip_radius_m - depth_m, 0}))}});
    }
    return film;
  }
  Result exported(const std::string& source, const std::string& foci, const std::vector<std::string>& more = {}) const {
    return palpa_here(with(
        {"export", "--scene", source_file("assets/cube.glb"), "--source", source, "--foci", foci, "--backend", "cpu"},
        more));
  }

  std::filesystem::path folder_ = scratch_folder("tracker");
};

TEST_F(Tracker, ARunAndAnExportTakeItsHands) {
  const Result run =
      succeeded(palpa_here({"run", "--scene", source_file("assets/cube.glb"), "--source", "joints:" + file("dip.jsonl"),
                            "--every-frame", "--backend", "cpu", "--stats", "json"}));
  EXPECT_EQ(run.err_without_lateness(), "");
  const json stats = json::parse(run.out);
  EXPECT_EQ(stats["frames"]["captured"], 30);
  EXPECT_GT(stats["frames"]["touching"], 20);
  EXPECT_FALSE(stats.contains("dropped")) << "a tracker sees no boards";

  const auto foci = [&](const std::vector<std::string>& more) {
    succeeded(exported("joints:" + file("dip.jsonl"), file("foci.csv"), more));
    return read_text(file("foci.csv"));
  };
  const std::string usual = foci({});
  EXPECT_GT(usual.size(), 5000U);
  EXPECT_EQ(usual, foci({"--delta", "3mm"})) << "the shell is thick unless it is given";
  EXPECT_NE(usual, foci({"--delta", "1.5mm"}));
}

TEST_F(Tracker, StandsWhereTheRigSays) {
  const auto foci_of = [&](const std::string& hands, const std::vector<std::string>& more) {
    succeeded(exported("joints:" + file(hands), file("foci.json"), more));
    std::vector<Vec3> foci;
    const json written = json::parse(read_text(file("foci.json")));
    for (const json& frame : written["frames"]) {
      for (const json& finger : frame["fingers"]) {
        for (const json& focus : finger["foci_m"])
          foci.emplace_back(focus[0], focus[1], focus[2]);
      }
    }
    return foci;
  };
  // One focus at the centroid: it depends little on where on the skin the points are.
  const std::vector<std::string> single{"--method", "single-focus"};
  const std::vector<Vec3> here = foci_of("dip.jsonl", single);
  const std::vector<Vec3> posed = foci_of("posed.jsonl", with(single, {"--rig", file("rig.toml")}));
  ASSERT_GT(here.size(), 20U);
  ASSERT_NEAR(static_cast<double>(here.size()), static_cast<double>(posed.size()), 2);
  EXPECT_LT(glm::distance(here[10], posed[10]), 0.5e-3);
  EXPECT_LT(glm::distance(here.back(), posed.back()), 0.5e-3);
}

// ---- the registration ---------------------------------------------------------------------------------------------

/// The direction from which the sound comes.
Vec3 towards_board(const array::Layout& board, const Vec3& focus) {
  Vec3 sum(0);
  for (const array::Transducer& transducer : board.transducers)
    sum += glm::normalize(transducer.position - focus);
  return glm::normalize(sum);
}

class Registration : public Tracker {
 protected:
  /// A person whose skin touches each focus with its underside, as a tracker sees it, for 0.3 s each. A tracker's
  /// joints move a little while the finger rests. `error_m` is added to each place of the tip in the world.
  static std::vector<sensing::TrackedFrame> touches(const std::vector<Vec3>& foci, const std::vector<Vec3>& error_m,
                                                    double sway_m = 0.1e-3) {
    const array::Layout own = array::load_layout("openmpd");
    const array::Layout board = array::transformed(own, own.default_T_world_layout);
    std::vector<sensing::TrackedFrame> film;
    for (std::size_t f = 0; f < foci.size(); ++f) {
      for (int i = 0; i < frames_each; ++i) {
        const Vec3 sway = sway_m * Vec3(std::sin(2.0 * i), std::cos(3.0 * i), std::sin(5.0 * i));
        const Vec3 tip = foci[f] - tip_radius_m * towards_board(board, foci[f]) + error_m[f] + sway;
        // Far apart in time, because the hand moves on.
        film.push_back({static_cast<double>(f) + 0.01 * i, {seen(glm::inverse(true_pose()), pointing_hand(tip))}});
      }
    }
    return film;
  }
  static constexpr int frames_each = 30;
  static std::vector<Vec3> the_foci() { return {setup::registration_foci.begin(), setup::registration_foci.end()}; }

  Result nudge(const std::vector<sensing::TrackedFrame>& film, const std::string& keys) const {
    write_text(file("touches.jsonl"), lines_of(film));
    return palpa_here({"calibrate", "--nudge", "--layout", "openmpd", "--source", "joints:" + file("touches.jsonl"),
                       "--keys", keys, "--out", file("registered.toml"), "--json", file("registered.json"), "--link",
                       "record:" + file("drives.bin"), "--hold", "2s", "--backend", "cpu"});
  }
  const std::string four_ = "wait*29 enter wait*29 enter wait*29 enter wait*29 enter";
};

TEST_F(Registration, FindsWhereTheTrackerStands) {
  succeeded(nudge(touches(the_foci(), std::vector<Vec3>(4, Vec3(0))), four_));
  const sensing::Rig rig = sensing::load_rig(file("registered.toml"));
  EXPECT_EQ(rig.array->layout, "openmpd");
  ASSERT_TRUE(rig.T_world_joints);
  ASSERT_TRUE(rig.joints_residual_m);
  EXPECT_LT(*rig.joints_residual_m, 0.1e-3);
  for (const Vec3& focus : the_foci()) {
    const Vec3 in_joints = transform_point(glm::inverse(true_pose()), focus);
    EXPECT_LT(glm::distance(transform_point(*rig.T_world_joints, in_joints), focus), 0.2e-3);
  }
  const json said = json::parse(read_text(file("registered.json")));
  EXPECT_EQ(said["saved"], true);
  EXPECT_EQ(said["residual_m"], *rig.joints_residual_m);
  EXPECT_EQ(said["touches"].size(), 4U);
  EXPECT_EQ(said["T_world_joints"][3], json({0.0, 0.0, 0.0, 1.0}));

  // What sounded last is the last focus, and then silence.
  EXPECT_LT(phases_off(last_sound(file("drives.bin")), array::load_layout("openmpd").default_T_world_layout,
                       the_foci().back()),
            5e-3);  // 3 um
}

TEST_F(Registration, FociMayBeNudged) {
  std::vector<Vec3> foci = the_foci();
  foci[1] += Vec3(-2e-3, 1e-3, 0);
  succeeded(nudge(touches(foci, std::vector<Vec3>(4, Vec3(0))),
                  "wait*29 enter left*2 up wait*26 enter wait*29 enter wait*29 enter"));
  EXPECT_LT(*sensing::load_rig(file("registered.toml")).joints_residual_m, 0.1e-3);
  // The second focus moves step by step. The next one is at its own place from its first drive on.
  std::vector<Vec3> sounds = the_foci();
  for (const Vec3& mm : {Vec3(-1, 0, 0), Vec3(-2, 0, 0), Vec3(-2, 1, 0)})
    sounds.push_back(the_foci()[1] + 1e-3 * mm);
  const Transform T_world_layout = array::load_layout("openmpd").default_T_world_layout;
  float phase = 0;  // of the drive before, of one of its transducers
  for (const RecordedDrive& one : read_to_silence(file("drives.bin")).drives) {
    if (loudest(one.drive) == 0 || std::exchange(phase, one.drive[7].phase) == one.drive[7].phase) continue;
    EXPECT_TRUE(std::ranges::any_of(sounds, [&](const Vec3& focus) {
      return phases_off(one.drive, T_world_layout, focus) < 5e-3;
    })) << one.slot;
  }
}

TEST_F(Registration, RefusesTouchesThatSayNothing) {
  const std::vector<Vec3> none(4, Vec3(0));
  const std::vector<Vec3> line{{-0.04, 0, 0}, {-0.01, 0, 0}, {0.01, 0, 1e-3}, {0.04, 0, 0}};
  std::vector<Vec3> off = none;
  off[2] = Vec3(0.06, 0, 0);
  const struct {
    std::vector<sensing::TrackedFrame> film;
    std::string keys;
    const char* told;
  } table[]{
      {touches(line, none), four_, "nearly on a line"},
      {touches(the_foci(), off), four_, "do not fit the foci"},
      {touches(the_foci(), none), "wait*29 enter wait*10", "before Enter was pressed at focus 2 of 4"},
      {touches(the_foci(), none, 8e-3), four_, "it ended at focus 1 of 4: hold the fingertip still"},
      {touches({the_foci()[0]}, none), four_, "before Enter was pressed at focus 2 of 4"},
  };
  for (const auto& [film, keys, told] : table) {
    expect_failure(nudge(film, keys), 1, told);
    EXPECT_FALSE(std::filesystem::exists(file("registered.toml"))) << told;
  }
  const Result left = succeeded(nudge(touches(the_foci(), none), "wait enter q"));
  EXPECT_CONTAINS(left.out, "nothing is saved");
  EXPECT_EQ(json::parse(read_text(file("registered.json")))["saved"], false);
}

TEST(SensationOnHand, PlaysAtThePalmAndTurnsWithIt) {
  const auto folder = scratch_folder("sensation-on-hand");
  const Vec3 tip(0.01, 0.02, 0.03);
  constexpr int frames = 120;  // it follows the hand until the file's end, and may be slow to begin
  std::vector<sensing::TrackedFrame> film;
  for (int i = 0; i < frames; ++i)
    film.push_back({0.01 * i, {pointing_hand(tip + Vec3(1e-7 * i, 0, 0))}});
  write_text(folder / "hand.jsonl", lines_of(film));
  const Transform hand = sensing::pose_of_joint(film[0].hands[0], sensing::palm_joint);
  // The fingers point down.
  const Vec3 palm = tip + Vec3(0.02, 0.12, 0);
  EXPECT_LT(glm::distance(Vec3(hand[3]), palm), 1e-9);
  EXPECT_LT(glm::distance(Vec3(hand[1]), Vec3(0, -1, 0)), 1e-9);
  EXPECT_NEAR(glm::determinant(hand), 1, 1e-9);
  const Transform T_world_layout = array::load_layout("openmpd").default_T_world_layout;
  for (const bool upright : {false, true}) {
    const auto file = (folder / (upright ? "upright.bin" : "turned.bin")).string();
    std::vector<std::string> line = words_of("play point --layout openmpd --on palm --link record:" + file +
                                             " --source joints:" + (folder / "hand.jsonl").string());
    if (upright) line.push_back("--upright");
    succeeded(palpa_here(line));
    EXPECT_LT(phases_off(last_sound(file), T_world_layout, palm), 0.01);
  }
  // It stays on the hand that it began with when another one is seen, too.
  for (const bool left : {false, true}) {
    std::vector<sensing::TrackedFrame> both;
    for (int i = 0; i < frames; ++i) {
      sensing::TrackedHand own = film[static_cast<std::size_t>(i)].hands[0];
      sensing::TrackedHand other = pointing_hand(tip + Vec3(-0.06, 1e-7 * i, 0.02));
      own.left = left;
      other.left = !left;
      both.push_back({0.01 * i, {own}});
      if (i >= 20) both.back().hands.insert(both.back().hands.begin() + i % 2, other);
    }
    write_text(folder / "both.jsonl", lines_of(both));
    const auto file = (folder / "both.bin").string();
    succeeded(palpa_here(words_of("play point --layout openmpd --on palm --link record:" + file +
                                  " --source joints:" + (folder / "both.jsonl").string())));
    EXPECT_LT(phases_off(last_sound(file), T_world_layout, palm), 0.01) << left;
  }
}

}  // namespace
}  // namespace palpa::test
