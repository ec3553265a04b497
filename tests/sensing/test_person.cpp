// Which tracked hands can be people's.
#include <gtest/gtest.h>

#include <functional>
#include <glm/geometric.hpp>
#include <random>
#include <string>
#include <vector>

#include "assets/generators/hand_bones.hpp"
#include "sensing/joints/person.hpp"
#include "sensing/joints/tracker.hpp"
#include "support/shared_data.hpp"
#include "support/tracked_hands.hpp"

namespace palpa::sensing {
namespace {

/// The length in mm of each bone, and the radius at each joint, of an adult's hand that is made up: flat, with all
/// fingers straight.
TrackedHand adult() {
  constexpr double bones_mm[5][4] = {
      {46, 32, 22, 0}, {68, 40, 22, 16}, {65, 45, 26, 17}, {58, 41, 26, 17}, {54, 33, 18, 16}};
  constexpr double radii_mm[5][5] = {
      {20, 12, 10, 9, 0}, {20, 11, 9, 8, 7}, {20, 11, 9, 8, 7}, {20, 10, 9, 8, 7}, {20, 9, 8, 7, 6}};
  TrackedHand hand;
  for (std::size_t f = 0; f < finger_joints.size(); ++f) {
    const auto [first, tip] = finger_joints[f];
    const Vec3 along = glm::normalize(f == 0 ? Vec3(-0.8, 0, 0.6) : Vec3(0.08 * (static_cast<double>(f) - 2), 0, 1));
    Vec3 place = f == 0 ? Vec3(-0.02, 0, 0) : Vec3(0.015 * (static_cast<double>(f) - 2), 0, 0.015);
    for (std::size_t j = first; j <= tip; ++j) {
      hand.joints[j] = place;
      hand.radii_m[j] = 1e-3 * radii_mm[f][j - first];
      if (j < tip) place += 1e-3 * bones_mm[f][j - first] * along;
    }
  }
  hand.joints[palm_joint] = {0, 0, 0.05};
  hand.radii_m[palm_joint] = hand.radii_m[wrist_joint] = 0.025;
  return hand;
}

TrackedHand scaled(TrackedHand hand, double by) {
  for (Vec3& joint : hand.joints)
    joint *= by;
  for (double& radius_m : hand.radii_m)
    radius_m *= by;
  return hand;
}

/// The joints of the hand that the assets are made of, an adult's.
TrackedHand posed(const assets::HandPose& pose, double by = 1) {
  const assets::HandBones bones = assets::pose_bones(pose);
  TrackedHand hand;
  for (std::size_t f = 0; f < finger_joints.size(); ++f) {
    std::size_t joint = finger_joints[f].first;
    const std::vector<assets::Bone>& finger = bones.digits[f].bones;
    const auto put = [&](const Vec3& place, double radius_m) {
      hand.joints[joint] = place;
      hand.radii_m[joint++] = radius_m;
    };
    const auto is_metacarpal = [&](const assets::Bone& bone) { return bone.b == finger[0].a; };
    const auto metacarpal = std::ranges::find_if(bones.palm, is_metacarpal);
    put(metacarpal->a, metacarpal->radius_a);
    for (const assets::Bone& bone : finger)
      put(bone.a, bone.radius_a);
    put(finger.back().b, finger.back().radius_b);
  }
  hand.joints[wrist_joint] = {-0.026, 0.176, 0};
  hand.joints[palm_joint] = 0.5 * (hand.joints[11] + hand.joints[12]);
  hand.radii_m[wrist_joint] = hand.radii_m[palm_joint] = 0.02;
  return scaled(hand, by);
}

struct Draw {
  std::mt19937_64 random{7};
  double from(double low, double high) { return std::uniform_real_distribution(low, high)(random); }
  double normal(double deviation) { return std::normal_distribution(0.0, deviation)(random); }
  Vec3 in_ball(double radius_m) {
    Vec3 place(0);
    do
      place = {from(-1, 1), from(-1, 1), from(-1, 1)};
    while (glm::length(place) > 1);
    return radius_m * place;
  }
  /// Fingers as far as they bend.
  assets::HandPose pose() {
    assets::HandPose pose{.thumb = {from(-0.2, 1), from(-0.1, 0.9), from(-0.3, 1.2), from(-0.4, 0.7)}, .fingers = {}};
    for (assets::FingerPose& finger : pose.fingers)
      finger = {from(-0.4, 1.6), from(-0.1, 1.95), from(-0.1, 1.4), from(-0.25, 0.4)};
    return pose;
  }
};

TEST(Person, HasHandsOfEveryUsualSizeInEveryPose) {
  Draw draw;
  for (int i = 0; i < 3000; ++i) {
    const double by = draw.from(0.5, 1.3);
    ASSERT_EQ(misfit_of(posed(draw.pose(), by)), std::nullopt) << i << ", " << by;
  }
  for (const char* name : {"spread", "point", "relaxed", "fist"}) {
    const assets::HandPose pose = *assets::named_hand_pose(name);
    for (int percent = 60; percent <= 130; ++percent)
      ASSERT_EQ(misfit_of(posed(pose, 0.01 * percent)), std::nullopt) << name << ", " << percent;
  }
}

TEST(Person, IsNoHandOfAnotherSize) {
  Draw draw;
  for (int percent = 1; percent <= 500; ++percent) {
    const double by = 0.01 * percent;
    if (percent > 33 && percent < 145) continue;
    ASSERT_NE(misfit_of(posed(draw.pose(), by)), std::nullopt) << percent;
    TrackedHand usual = posed(draw.pose());
    usual.joints = scaled(usual, by).joints;
    ASSERT_EQ(misfit_of(usual), Misfit::size) << percent << ", with usual radii";
  }
}

TEST(Person, IsNoCloudOfJoints) {
  Draw draw;
  for (const double radius_m : {0.1e-3, 1e-3, 4e-3, 5e-3, 6e-3, 7e-3, 10e-3, 15e-3, 20e-3, 30e-3, 40e-3, 60e-3}) {
    for (int i = 0; i < 2000; ++i) {
      TrackedHand hand = posed(draw.pose());
      const Vec3 centre = draw.in_ball(0.5);
      for (Vec3& joint : hand.joints)
        joint = centre + draw.in_ball(radius_m);
      ASSERT_NE(misfit_of(hand), std::nullopt) << "in a ball of " << radius_m << ", " << i;
      for (Vec3& joint : hand.joints)
        joint = centre + Vec3(draw.normal(radius_m), draw.normal(radius_m), draw.normal(radius_m));
      ASSERT_NE(misfit_of(hand), std::nullopt) << "with a deviation of " << radius_m << ", " << i;
    }
  }
}

TEST(Person, HasNoJointElsewhere) {
  Draw draw;
  for (int i = 0; i < 200; ++i) {
    TrackedHand hand = posed(draw.pose(), draw.from(0.6, 1.3));
    const Vec3 place = Vec3(0.6, 0, 0) + draw.in_ball(0.2);
    for (Vec3& joint : hand.joints)
      joint += place;
    ASSERT_EQ(misfit_of(hand), std::nullopt);
    const auto refused = [&](const std::function<void(TrackedHand&)>& change) {
      TrackedHand other = hand;
      change(other);
      return misfit_of(other).has_value();
    };
    for (std::size_t j = 0; j < joint_count; ++j) {
      EXPECT_TRUE(refused([&](TrackedHand& h) { h.joints[j] = Vec3(0); })) << "joint at zero: " << j;
      for (int axis = 0; axis < 3; ++axis)
        EXPECT_TRUE(refused([&](TrackedHand& h) { h.joints[j][axis] = NAN; })) << "no number: " << j;
      EXPECT_TRUE(refused([&](TrackedHand& h) { h.joints[j].y = INFINITY; })) << "infinite: " << j;
      EXPECT_TRUE(refused([&](TrackedHand& h) { h.radii_m[j] = NAN; })) << "no radius: " << j;
    }
    EXPECT_TRUE(refused([](TrackedHand& h) { h.joints.fill(h.joints[wrist_joint]); }));
    EXPECT_TRUE(refused([](TrackedHand& h) { h.joints[palm_joint].z += 5; }));
    for (const auto& [first, tip] : finger_joints) {
      const Vec3 away = 0.5 * glm::normalize(draw.in_ball(1));
      EXPECT_TRUE(refused([&, begin = first, end = tip](TrackedHand& h) {
        for (std::size_t j = begin; j <= end; ++j)
          h.joints[j] += away;
      })) << "half a metre away: "
          << first;
    }
    if (HasFailure()) return;
  }
}

TEST(Person, MayBeAChildOrHaveLongHands) {
  // From wrist to tip, this hand is 173 mm long.
  for (const double by : {0.56, 0.7, 1.0, 1.1, 1.27})
    EXPECT_EQ(misfit_of(scaled(adult(), by)), std::nullopt) << by;
  TrackedHand child = scaled(adult(), 0.6);
  child.radii_m = adult().radii_m;
  EXPECT_EQ(misfit_of(child), std::nullopt) << "a tracker that gives everybody the same radii";
  EXPECT_EQ(misfit_of(test::pointing_hand({0, 0, 0})), std::nullopt);
}

TEST(Person, MayBendFingersAndLackMetacarpals) {
  TrackedHand fist = adult();
  for (std::size_t f = 1; f < finger_joints.size(); ++f) {
    const std::size_t knuckle = finger_joints[f].first + 1;
    for (std::size_t j = knuckle + 1; j <= finger_joints[f].second; ++j) {
      const Vec3 bone = adult().joints[j] - adult().joints[j - 1];
      const double turn = -1.4 * static_cast<double>(j - knuckle);
      fist.joints[j] = fist.joints[j - 1] + Vec3(bone.x, std::sin(turn) * bone.z, std::cos(turn) * bone.z);
    }
  }
  EXPECT_EQ(misfit_of(fist), std::nullopt);
  TrackedHand without = adult();
  for (std::size_t f = 1; f < finger_joints.size(); ++f)
    without.joints[finger_joints[f].first] = without.joints[finger_joints[f].first + 1];
  EXPECT_EQ(misfit_of(without), std::nullopt);
}

TEST(Person, IsNoneOfTheHandsThatTrackersMakeUp) {
  const auto changed = [](const std::function<void(TrackedHand&)>& change) {
    TrackedHand hand = adult();
    change(hand);
    return hand;
  };
  const auto finger = [&](std::size_t f, const std::function<void(Vec3&)>& change) {
    return changed([&](TrackedHand& hand) {
      for (std::size_t j = finger_joints[f].first; j <= finger_joints[f].second; ++j)
        change(hand.joints[j]);
    });
  };
  for (std::size_t f = 0; f < finger_joints.size(); ++f) {
    EXPECT_EQ(misfit_of(finger(f, [](Vec3& joint) { joint = Vec3(0); })), Misfit::shape) << "finger at zero: " << f;
    EXPECT_EQ(misfit_of(finger(f, [](Vec3& joint) { joint.y += 0.5; })), Misfit::shape) << "half a metre away: " << f;
  }
  using Change = std::function<void(TrackedHand&)>;
  const std::pair<Change, Misfit> table[]{
      {[](TrackedHand& h) { h.joints.fill(Vec3(0)); }, Misfit::size},
      {[](TrackedHand& h) { h.joints.fill(h.joints[wrist_joint]); }, Misfit::size},
      {[](TrackedHand& h) { h = scaled(h, 0.05); }, Misfit::radius},
      {[](TrackedHand& h) { h = scaled(h, 2); }, Misfit::radius},
      {[](TrackedHand& h) { h.joints = scaled(h, 0.05).joints; }, Misfit::size},
      {[](TrackedHand& h) { h.joints = scaled(h, 2).joints; }, Misfit::size},
      {[](TrackedHand& h) { h.joints[palm_joint].x = 5; }, Misfit::shape},
      {[](TrackedHand& h) { h.joints[wrist_joint].x = 5; }, Misfit::shape},
      {[](TrackedHand& h) {
         h.joints[index_tip_joint] = {0.5, 0, 0};
       },
       Misfit::shape},
      {[](TrackedHand& h) { h.joints[index_tip_joint] = h.joints[index_tip_joint - 1]; }, Misfit::shape},
      {[](TrackedHand& h) { std::copy_n(&h.joints[6], 5, &h.joints[11]); }, Misfit::shape},
      {[](TrackedHand& h) { h.radii_m[index_tip_joint] = 0; }, Misfit::radius},
      {[](TrackedHand& h) { h.radii_m[index_tip_joint] = -7e-3; }, Misfit::radius},
      {[](TrackedHand& h) { h.radii_m[index_tip_joint] = 24e-3; }, Misfit::radius},
      {[](TrackedHand& h) { h.radii_m[palm_joint] = 0.041; }, Misfit::radius},
      {[](TrackedHand& h) { h.radii_m.fill(30e-3); }, Misfit::radius},
      {[](TrackedHand& h) { h.joints[index_tip_joint].x = NAN; }, Misfit::size},
      {[](TrackedHand& h) { h.radii_m[3] = NAN; }, Misfit::radius},
  };
  int row = 0;
  for (const auto& [change, misfit] : table) {
    EXPECT_EQ(misfit_of(changed(change)), misfit) << "row " << row;
    ++row;
  }
}

TEST(Person, IsLeftOfTheFoundFilesWhereThereIsOne) {
  // File, frames with a hand of a person.
  const std::pair<const char*, int> table[]{
      {"1_lost_zero", -1},   {"1_zero_noisy", 0},          {"1_all_at_wrist", 0}, {"1_hand_a_twentieth", 0},
      {"1_palm_5m_away", 0}, {"tap-then-light-100ms", 89}, {"two-taps-80ms", 83}};
  for (const auto& [name, wanted] : table) {
    PALPA_SHARED_OR_SKIP(file, std::string("found/") + name + ".jsonl");
    const auto tracker = open_tracker(file.string(), false);
    TrackedFrame frame;
    bool came = false;
    std::uint64_t number = 0;
    int hands = 0;
    while (tracker->next(frame, came, number, 0)) {
      hands += static_cast<int>(frame.hands.size());
      for (const TrackedHand& hand : frame.hands)
        EXPECT_GT(glm::distance(hand.joints[palm_joint], hand.joints[index_tip_joint]), 0.05) << name;
    }
    if (wanted >= 0) {
      EXPECT_EQ(hands, wanted) << name;
    }
  }
}

}  // namespace
}  // namespace palpa::sensing
