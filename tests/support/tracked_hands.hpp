// Hands of a tracker that tests make up, and their lines of JSON.
#pragma once

#include <array>
#include <cstddef>
#include <cstdio>
#include <string>
#include <vector>

#include "base/math.hpp"
#include "sensing/joints/tracked_hand.hpp"

namespace palpa::test {

/// A right hand above its index finger, which points straight down. The other fingertips are 60 mm higher. The index
/// tip's ball has its centre at `index_tip`, and a radius of 7 mm.
inline sensing::TrackedHand pointing_hand(const Vec3& index_tip) {
  constexpr std::array<double, 4> lengths_m{0.065, 0.040, 0.025, 0.018};
  sensing::TrackedHand hand;
  hand.radii_m.fill(8e-3);
  for (std::size_t f = 0; f < sensing::finger_joints.size(); ++f) {
    const auto [first, tip] = sensing::finger_joints[f];
    hand.radii_m[tip] = 7e-3;
    Vec3 place = index_tip + Vec3(0.02 * (static_cast<double>(f) - 1), f == 1 ? 0 : 0.06, 0);
    for (std::size_t j = tip;; --j) {
      hand.joints[j] = place;
      if (j == first) break;
      place.y += lengths_m[lengths_m.size() - 1 - (tip - j)];
    }
  }
  hand.joints[sensing::palm_joint] = index_tip + Vec3(0.02, 0.12, 0);
  hand.joints[sensing::wrist_joint] = index_tip + Vec3(0.02, 0.25, 0);
  return hand;
}

/// A frame in palpa's form, with all digits.
inline std::string line_of(const sensing::TrackedFrame& frame) {
  const auto list = [](const auto& values, const auto& text_of) {
    std::string text;
    for (const auto& value : values)
      text += (text.empty() ? "" : ", ") + text_of(value);
    return "[" + text + "]";
  };
  const auto number = [](double value) {
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%.17g", value);
    return std::string(text.data());
  };
  const auto place = [&](const Vec3& p) { return list(std::array{p.x, p.y, p.z}, number); };
  const auto hand_of = [&](const sensing::TrackedHand& hand) {
    return std::string("{\"hand\": \"") + (hand.left ? "left" : "right") +
           "\", \"joints\": " + list(hand.joints, place) + ", \"radii\": " + list(hand.radii_m, number) + "}";
  };
  return "{\"t_s\": " + number(frame.time_s) + ", \"hands\": " + list(frame.hands, hand_of) + "}";
}

/// A file's text: a line for each frame.
inline std::string lines_of(const std::vector<sensing::TrackedFrame>& frames) {
  std::string text;
  for (const sensing::TrackedFrame& frame : frames)
    text += line_of(frame) + "\n";
  return text;
}

}  // namespace palpa::test
