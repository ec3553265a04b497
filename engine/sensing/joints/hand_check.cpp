#include "sensing/joints/hand_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

namespace palpa::sensing {
namespace {

bool is_far(const TrackedHand& hand) {
  return !std::ranges::all_of(hand.joints, [](const Vec3& joint) { return glm::length(joint) <= farthest_joint_m; });
}

bool is_of_person(const TrackedHand& hand) {
  const auto is_radius = [](double radius_m) { return radius_m >= least_radius_m && radius_m <= most_radius_m; };
  if (!std::ranges::all_of(hand.radii_m, is_radius)) return false;
  return std::ranges::all_of(finger_joints, [&](const auto& finger) {
    for (std::size_t j = finger.first; j < finger.second; ++j) {
      if (!(glm::distance(hand.joints[j], hand.joints[j + 1]) <= longest_bone_m)) return false;
    }
    return true;
  });
}

bool jumped(const TrackedHand& from, const TrackedHand& to, double time_s) {
  for (std::size_t j = 0; j < joint_count; ++j) {
    if (!(glm::distance(from.joints[j], to.joints[j]) <= fastest_joint_m_s * time_s)) return true;
  }
  return false;
}

}  // namespace

/// Speeds are of the tracker's clock, so it has to run as palpa's does.
bool HandCheck::trusts_clock(double time_s, double arrived_s) {
  const double ahead_s = time_s - arrived_s;
  const bool apart = std::abs(ahead_s - ahead_s_) > longest_delay_s;
  const bool begins = frames_ < 2;  // the first frame may have waited for palpa
  if (begins) ++frames_;
  if (!begins && !apart && arrived_s - since_s_ < longest_delay_s) return trusted_;
  trusted_ = begins || !apart;
  ahead_s_ = ahead_s;
  since_s_ = arrived_s;
  return trusted_;
}

std::optional<HandDoubt> HandCheck::doubt_of(const TrackedHand& hand, double time_s, double arrived_s) {
  if (is_far(hand)) return HandDoubt::far;
  if (!is_of_person(hand)) return HandDoubt::size;
  Seen& seen = seen_[hand.left ? 1 : 0];
  const double since_s = time_s - seen.time_s;
  const bool follows = seen.known && since_s > 0 && since_s <= longest_gap_s;
  const bool still = seen.known && hand.joints == seen.hand.joints;
  const bool jumps = follows && jumped(seen.hand, hand, since_s);
  seen = {true, hand, time_s, still ? seen.moved_s : arrived_s};
  if (jumps) return HandDoubt::jump;
  if (arrived_s - seen.moved_s > longest_rest_s) return HandDoubt::frozen;
  return std::nullopt;
}

std::optional<HandDoubt> HandCheck::check(TrackedFrame& frame, double arrived_s) {
  std::vector<TrackedHand>& hands = frame.hands;
  const bool trusted = trusts_clock(frame.time_s, arrived_s);
  if (hands.empty()) return std::nullopt;
  if (!trusted) {
    hands.clear();
    return HandDoubt::clock;
  }
  if (hands.size() > 2 || (hands.size() == 2 && hands[0].left == hands[1].left)) {
    hands.clear();
    return HandDoubt::crowd;
  }
  std::optional<HandDoubt> doubt;
  std::erase_if(hands, [&](const TrackedHand& hand) {
    const std::optional<HandDoubt> why = doubt_of(hand, frame.time_s, arrived_s);
    if (why) doubt = why;
    return why.has_value();
  });
  return doubt;
}

std::string to_text(HandDoubt doubt) {
  switch (doubt) {
    case HandDoubt::clock:
      return "the hands of frames whose times do not run with this computer's clock: t_s must be seconds";
    case HandDoubt::crowd:
      return "the hands of a frame that has more than one left and one right hand";
    case HandDoubt::far:
      return fmt::format("a hand with a joint more than {} m from the tracker (coordinates are metres)",
                         farthest_joint_m);
    case HandDoubt::size:
      return fmt::format("a hand with a radius outside of {} to {} mm, or with a bone longer than {} mm",
                         least_radius_m * 1e3, most_radius_m * 1e3, longest_bone_m * 1e3);
    case HandDoubt::jump:
      return fmt::format("a hand with a joint that moved faster than {} m/s", fastest_joint_m_s);
    case HandDoubt::frozen:
      return fmt::format("a hand whose joints have not moved for {} s", longest_rest_s);
  }
  return {};
}

}  // namespace palpa::sensing
