#include "sensing/joints/read_frame.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>

#include "geometry/gltf_document/json.hpp"

namespace palpa::sensing {
namespace {

using geometry::gltf::Item;
using geometry::gltf::Json;

constexpr double most_time_s = 1e12;
/// More hands are read no further. Two are plausible.
constexpr std::size_t most_hands = 8;

double number(const Item& item, const char* key) {
  const auto found = item.json().find(key);
  if (found == item.json().end()) item.fail(fmt::format("\"{}\" is missing", key));
  if (!found->is_number() || !std::isfinite(found->get<double>()))
    item.fail(fmt::format("\"{}\" is not a finite number", key));
  return found->get<double>();
}

double time_of(const Item& frame, const char* key, double unit_s) {
  const double time_s = number(frame, key) * unit_s;
  if (!(std::abs(time_s) <= most_time_s)) frame.fail(fmt::format("\"{}\" is no time in seconds", key));
  return time_s;
}

std::size_t size_of_needed(const Item& item, const char* key) {
  if (item.array(key) == nullptr) item.fail(fmt::format("\"{}\" is missing", key));
  return item.size(key);
}

bool is_left(const Item& hand, const char* key) {
  const std::string side = hand.string(key).value_or("");
  if (side != "left" && side != "right") hand.fail(fmt::format("\"{}\" must be \"left\" or \"right\"", key));
  return side == "left";
}

// ---- palpa's form ---------------------------------------------------------------------------------------------------

Vec3 joint_of(const Item& hand, std::size_t number) {
  const Json& joint = (*hand.array("joints"))[number];
  const bool is_place = joint.is_array() && (joint.size() == 3 || joint.size() == 7);
  if (!is_place || !std::ranges::all_of(joint, [](const Json& value) { return value.is_number(); }))
    hand.fail(fmt::format("joint {} must be [x, y, z] or [x, y, z, qx, qy, qz, qw]", number));
  return {joint[0].get<double>(), joint[1].get<double>(), joint[2].get<double>()};
}

TrackedHand hand_of(const Item& item) {
  TrackedHand hand;
  hand.left = is_left(item, "hand");
  if (const std::size_t joints = size_of_needed(item, "joints"); joints != joint_count)
    item.fail(fmt::format("has {} joints; OpenXR's XR_EXT_hand_tracking has {}", joints, joint_count));
  for (std::size_t j = 0; j < joint_count; ++j)
    hand.joints[j] = joint_of(item, j);
  const auto radii = item.numbers("radii", joint_count);
  if (!radii) item.fail("\"radii\" is missing");
  std::ranges::copy(*radii, hand.radii_m.begin());
  return hand;
}

TrackedFrame own_frame(const Item& item) {
  TrackedFrame frame{.time_s = time_of(item, "t_s", 1), .hands = {}};
  const std::size_t hands = std::min(size_of_needed(item, "hands"), most_hands);
  for (std::size_t h = 0; h < hands; ++h)
    frame.hands.push_back(hand_of(item.element("hands", "hand", h)));
  return frame;
}

// ---- Leap's form: millimetres, microseconds -------------------------------------------------------------------------

Vec3 place_of(const Item& item, const char* key) {
  const auto place = item.numbers(key, 3);
  if (!place) item.fail(fmt::format("\"{}\" is missing", key));
  return 1e-3 * Vec3((*place)[0], (*place)[1], (*place)[2]);
}

/// Fills the joints of one finger but the base of its metacarpal, and all its radii. Leap's tip is the end of the
/// finger, so the joint lies a radius before it. Returns the finger's number, from the thumb.
std::size_t take_finger(const Item& finger, TrackedHand& hand) {
  const std::size_t type = finger.needed_whole("type", 0, 4);
  const auto [first, tip] = finger_joints[type];
  const double radius_m = 0.5e-3 * number(finger, "width");
  for (std::size_t j = first; j <= tip; ++j)
    hand.radii_m[j] = radius_m;
  hand.joints[tip - 1] = place_of(finger, "dipPosition");
  hand.joints[tip - 2] = place_of(finger, "pipPosition");
  hand.joints[tip - 3] = place_of(finger, "mcpPosition");
  const Vec3 end = place_of(finger, finger.has("btipPosition") ? "btipPosition" : "tipPosition");
  const Vec3 bone = end - hand.joints[tip - 1];
  const double length_m = glm::length(bone);
  hand.joints[tip] = length_m > radius_m ? end - bone * (radius_m / length_m) : hand.joints[tip - 1];
  if (type > 0 && finger.has("carpPosition")) hand.joints[first] = place_of(finger, "carpPosition");
  return type;
}

TrackedHand leap_hand(const Item& frame, const Item& item) {
  TrackedHand hand;
  hand.left = is_left(item, "type");
  const std::uint64_t id = item.needed_whole("id", 0, UINT32_MAX);
  std::array<bool, finger_joints.size()> there{}, has_base{};
  const std::size_t pointables = std::min<std::size_t>(size_of_needed(frame, "pointables"), 5 * most_hands);
  for (std::size_t p = 0; p < pointables; ++p) {
    const Item pointable = frame.element("pointables", "pointable", p);
    const auto tool = pointable.json().find("tool");
    if (tool != pointable.json().end() && *tool == Json(true)) continue;
    if (pointable.needed_whole("handId", 0, UINT32_MAX) != id) continue;
    const std::size_t type = take_finger(pointable, hand);
    there[type] = true;
    has_base[type] = pointable.has("carpPosition");
  }
  if (!std::ranges::all_of(there, [](bool finger) { return finger; })) item.fail("has not all five fingers");
  const Vec3 palm = place_of(item, "palmPosition");
  Vec3 knuckles(0);
  for (std::size_t f = 1; f < finger_joints.size(); ++f)
    knuckles += 0.25 * hand.joints[finger_joints[f].first + 1];
  // Where the metacarpals' bases are missing, the bones lie side by side and have their middle at the palm's.
  for (std::size_t f = 1; f < finger_joints.size(); ++f) {
    const std::size_t base = finger_joints[f].first;
    if (!has_base[f]) hand.joints[base] = hand.joints[base + 1] - 2.0 * (knuckles - palm);
  }
  hand.joints[palm_joint] = palm;
  hand.joints[wrist_joint] = item.has("wrist") ? place_of(item, "wrist") : hand.joints[finger_joints[2].first];
  hand.radii_m[palm_joint] = hand.radii_m[wrist_joint] = hand.radii_m[finger_joints[2].first];
  return hand;
}

std::optional<TrackedFrame> leap_frame(const Item& item) {
  if (const auto version = item.whole("version", 0, UINT32_MAX); version && *version != 6)
    item.fail(fmt::format("is of version {} of Leap's protocol; palpa reads version 6", *version));
  if (!item.has("timestamp")) return std::nullopt;
  TrackedFrame frame{.time_s = time_of(item, "timestamp", 1e-6), .hands = {}};
  const std::size_t hands = std::min(size_of_needed(item, "hands"), most_hands);
  for (std::size_t h = 0; h < hands; ++h)
    frame.hands.push_back(leap_hand(item, item.element("hands", "hand", h)));
  return frame;
}

}  // namespace

std::optional<TrackedFrame> read_frame(const std::string& line, const std::string& name) {
  const geometry::gltf::Parsed parsed(name, line);
  const Item item(name, parsed.json(), "the frame");
  const bool of_leap = item.has("timestamp") || item.has("version") || item.has("event");
  if (!of_leap && !item.has("t_s")) item.fail("has neither \"t_s\" nor, as a Leap's, \"timestamp\"");
  return of_leap ? leap_frame(item) : own_frame(item);
}

}  // namespace palpa::sensing
