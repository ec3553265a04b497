// Exactly at the limits of trackers, cameras and rigs: what the value itself does, and what the next one does.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sensing/camera.hpp"
#include "sensing/joints/hand_check.hpp"
#include "sensing/joints/read_frame.hpp"
#include "sensing/recording.hpp"
#include "sensing/rig.hpp"
#include "support/captured.hpp"
#include "support/files.hpp"
#include "support/shared_data.hpp"
#include "support/thrown.hpp"
#include "support/tracked_hands.hpp"

namespace palpa::sensing {
namespace {

double after(double value) {
  return std::nextafter(value, std::numeric_limits<double>::infinity());
}

/// A pointing hand at that z. The z of all its joints are the same, so distances along z are exact.
TrackedHand hand_at(double z, bool left = false) {
  TrackedHand hand = test::pointing_hand({0, 0.1, 0});
  for (Vec3& joint : hand.joints)
    joint.z = z;
  hand.left = left;
  return hand;
}

struct Seen {
  std::vector<TrackedHand> hands;
  double time_s = 0;
  std::optional<double> arrived_s{};  ///< else at its time
};

/// The doubt about the last of these frames.
std::optional<HandDoubt> doubt_of(const std::vector<Seen>& frames) {
  HandCheck check;
  std::optional<HandDoubt> doubt;
  for (const Seen& seen : frames) {
    TrackedFrame frame{seen.time_s, seen.hands};
    doubt = check.check(frame, seen.arrived_s.value_or(seen.time_s));
  }
  return doubt;
}

TEST(AtLimits, HandsAreInDoubtBeyondTheirLimits) {
  for (const bool beyond : {false, true}) {
    const auto of = [&](double limit) { return beyond ? after(limit) : limit; };
    const auto doubt_if = [&](HandDoubt doubt) { return beyond ? std::optional(doubt) : std::nullopt; };
    TrackedHand far = hand_at(0);
    far.joints[4] = {0, 0, of(farthest_joint_m)};
    EXPECT_EQ(doubt_of({{{far}}}), beyond ? HandDoubt::far : HandDoubt::shape);
    constexpr double step_s = 1.0 / 128;  // exact, as the way in it is
    EXPECT_EQ(doubt_of({{{hand_at(0)}}, {{hand_at(of(fastest_joint_m_s * step_s))}, step_s}}),
              doubt_if(HandDoubt::jump));
    const double rested_s = of(longest_rest_s);
    EXPECT_EQ(doubt_of({{{hand_at(0)}}, {{hand_at(0)}, rested_s}}), doubt_if(HandDoubt::frozen));
    const double gap_s = of(longest_gap_s);
    EXPECT_EQ(doubt_of({{{hand_at(0)}}, {{hand_at(2)}, gap_s}}),
              beyond ? std::nullopt : std::optional(HandDoubt::jump));
  }
}

TEST(AtLimits, AHandThatChangesItsSideIsInDoubtUpToTheLimits) {
  for (const bool beyond : {false, true}) {
    const auto of = [&](double limit) { return beyond ? after(limit) : limit; };
    const auto side = beyond ? std::nullopt : std::optional(HandDoubt::side);
    const Seen first{{hand_at(0)}, 0}, none{{}, 0.125};
    EXPECT_EQ(doubt_of({first, none, {{hand_at(0.01, true)}, of(longest_gap_s)}}), side);
    EXPECT_EQ(doubt_of({first, none, {{hand_at(of(same_place_m), true)}, 0.2}}), side);
    const Seen other{{hand_at(0.01, true)}, 0};
    EXPECT_EQ(doubt_of({first, other, {{hand_at(0.02, true)}, of(longest_gap_s)}}), side);
  }
}

TEST(AtLimits, ATrackersClockIsTrustedUpToItsDelayAndAgainAfterIt) {
  for (const bool beyond : {false, true}) {
    const double late_s = beyond ? after(2 + longest_delay_s) : 2 + longest_delay_s;
    EXPECT_EQ(doubt_of({{{hand_at(0)}}, {{hand_at(0.01)}, 1}, {{hand_at(0.02)}, late_s, 2.0}}),
              beyond ? std::optional(HandDoubt::clock) : std::nullopt);
    const double again_s = beyond ? 2 + longest_delay_s : std::nextafter(2 + longest_delay_s, 0);
    EXPECT_EQ(doubt_of({{{hand_at(0)}},
                        {{hand_at(0.01)}, 1},
                        {{hand_at(0.02)}, 102, 2.0},
                        {{hand_at(0.03)}, 100 + again_s, again_s}}),
              beyond ? std::nullopt : std::optional(HandDoubt::clock));
  }
}

TEST(AtLimits, TimesOfTrackersAreReadUpToTheirLimit) {
  for (const double sign : {1.0, -1.0}) {
    EXPECT_EQ(read_frame(test::line_of({sign * 1e12, {}}), "it").value().time_s, sign * 1e12);
    EXPECT_REFUSED(read_frame(test::line_of({sign * after(1e12), {}}), "it"), "is no time");
  }
}

TEST(AtLimits, CamerasAreImplausibleBeyondTheirLimits) {
  EXPECT_EQ(implausible_range(5), "");
  EXPECT_NE(implausible_range(after(5)), "");
  EXPECT_EQ(implausible_unit(0.01) + implausible_unit(1e-6), "");
  EXPECT_NE(implausible_unit(after(0.01)), "");
  EXPECT_NE(implausible_unit(std::nextafter(1e-6, 0)), "");
}

struct RigAtLimits : testing::Test {
  std::filesystem::path file = test::scratch_folder("rig-at-limits") / "rig.toml";
  Rig load(const std::string& more) const {
    test::write_text(file, R"([[camera]]
name = "one"
width = 8
height = 8
fx = 8
fy = 8
cx = 4
cy = 4
depth_unit_m = 0.001
min_range_m = 0
rate_hz = 90
T_world_camera = [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]
)" + more);
    return load_rig(file);
  }
};

TEST_F(RigAtLimits, PlacesAreReadUpToTheirLimits) {
  const auto pose = [](const std::string& x) {
    return "[[1, 0, 0, " + x + "], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]";
  };
  const std::string screen = "[screen]\nwidth_m = 1\nheight_m = 1\nT_world_screen = " + pose("0") + "\neye_m = ";
  EXPECT_EQ(load(screen + "[0, -1e4, 1e4]").screen->eye_m.z, 1e4);
  EXPECT_REFUSED(load(screen + "[0, 0, 10000.00001]"), "eye_m lies more than");
  EXPECT_REFUSED(load(screen + "[0, -10000.00001, 0]"), "eye_m lies more than");
  const std::string room = "[room]\nlow_m = [-1e4, -1e4, -1e4]\nhigh_m = ";
  EXPECT_EQ(load(room + "[1e4, 1e4, 1e4]").room->box.high.y, 1e4);
  EXPECT_REFUSED(load(room + "[1e4, 10000.00001, 1e4]"), "the room reaches more than");
  const auto said = [&](const std::string& x) {
    return test::stderr_of([&] { load("[joints]\nT_world_joints = " + pose(x) + "\n"); });
  };
  EXPECT_EQ(said("20") + said("-20"), "");
  EXPECT_CONTAINS(said("20.00000001"), "from the world's origin");
}

}  // namespace
}  // namespace palpa::sensing
