#include "sensing/joints/hand_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <utility>

#include "sensing/joints/person.hpp"

namespace palpa::sensing {
namespace {

bool is_far(const TrackedHand& hand) {
  return !std::ranges::all_of(hand.joints, [](const Vec3& joint) { return glm::length(joint) <= farthest_joint_m; });
}

std::optional<HandDoubt> doubt_about(const std::optional<Misfit>& misfit) {
  if (!misfit) return std::nullopt;
  switch (*misfit) {
    case Misfit::radius:
      return HandDoubt::radius;
    case Misfit::size:
      return HandDoubt::size;
    case Misfit::shape:
      return HandDoubt::shape;
  }
  return HandDoubt::shape;
}

std::size_t side_of(const TrackedHand& hand) {
  return hand.left ? 1 : 0;
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

/// Whether the frame's only hand was of the other side shortly before.
bool HandCheck::changed_side(const TrackedFrame& frame) const {
  if (frame.hands.size() != 1) return false;
  const TrackedHand& hand = frame.hands.front();
  const std::size_t side = side_of(hand), other = 1 - side;
  if (before_[side]) return false;
  if (before_[other]) return true;
  const Seen& gone = seen_[other];
  if (seen_[side].known && seen_[side].time_s >= gone.time_s) return false;
  return gone.known && frame.time_s - gone.time_s <= longest_gap_s &&
         glm::distance(gone.hand.joints[palm_joint], hand.joints[palm_joint]) <= same_place_m;
}

std::optional<HandDoubt> HandCheck::doubt_of(const TrackedHand& hand, double time_s, double arrived_s) {
  if (is_far(hand)) return HandDoubt::far;
  if (const std::optional<HandDoubt> doubt = doubt_about(misfit_of(hand))) return doubt;
  Seen& seen = seen_[side_of(hand)];
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
  const std::optional<HandDoubt> doubt = remove_doubtful(frame, arrived_s);
  frame.in_doubt = doubt.has_value();
  return doubt;
}

std::optional<HandDoubt> HandCheck::remove_doubtful(TrackedFrame& frame, double arrived_s) {
  std::vector<TrackedHand>& hands = frame.hands;
  const bool trusted = trusts_clock(frame.time_s, arrived_s);
  if (changed_side(frame)) side_s_ = arrived_s;
  before_ = {};
  for (const TrackedHand& hand : hands)
    before_[side_of(hand)] = true;
  if (hands.empty()) return std::nullopt;
  if (!trusted) {
    hands.clear();
    return HandDoubt::clock;
  }
  if (hands.size() > 2 || (hands.size() == 2 && hands[0].left == hands[1].left)) {
    hands.clear();
    return HandDoubt::crowd;
  }
  const bool in_doubt = hands.size() == 1 && side_s_ && arrived_s - *side_s_ <= longest_gap_s;
  std::optional<HandDoubt> doubt;
  std::erase_if(hands, [&](const TrackedHand& hand) {
    std::optional<HandDoubt> why = doubt_of(hand, frame.time_s, arrived_s);
    if (!why && in_doubt) why = HandDoubt::side;
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
    case HandDoubt::side:
      return fmt::format("a hand for {} s after it changed from left to right, or from right to left", longest_gap_s);
    case HandDoubt::far:
      return fmt::format("a hand with a joint more than {} m from the tracker (coordinates are metres)",
                         farthest_joint_m);
    case HandDoubt::radius:
      return fmt::format(
          "a hand with a radius outside of {} to {} mm ({} to {} mm at fingers), or far from those of its other "
          "fingers",
          any_radius_m.least * 1e3, any_radius_m.most * 1e3, finger_radius_m.least * 1e3, finger_radius_m.most * 1e3);
    case HandDoubt::size:
      return fmt::format("a hand whose fingers have a median length outside of {} to {} mm from knuckle to tip",
                         hand_size_m.least * 1e3, hand_size_m.most * 1e3);
    case HandDoubt::shape:
      return "a hand with a bone, palm or wrist that does not fit its other joints";
    case HandDoubt::jump:
      return fmt::format("a hand with a joint that moved faster than {} m/s", fastest_joint_m_s);
    case HandDoubt::frozen:
      return fmt::format("a hand whose joints have not moved for {} s", longest_rest_s);
  }
  return {};
}

}  // namespace palpa::sensing
