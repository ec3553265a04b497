#include "sensing/joints/person.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <glm/geometric.hpp>
#include <span>

namespace palpa::sensing {
namespace {

constexpr std::size_t fingers = finger_joints.size();

/// The first joint of a finger's own bones: the knuckle, but the thumb's first joint.
std::size_t root_of(std::size_t finger) {
  return finger_joints[finger].first + (finger == 0 ? 0 : 1);
}
std::size_t tip_of(std::size_t finger) {
  return finger_joints[finger].second;
}

double bone_m(const TrackedHand& hand, std::size_t joint) {
  return glm::distance(hand.joints[joint], hand.joints[joint + 1]);
}

double length_m(const TrackedHand& hand, std::size_t finger) {
  double sum_m = 0;
  for (std::size_t j = root_of(finger); j < tip_of(finger); ++j)
    sum_m += bone_m(hand, j);
  return sum_m;
}

/// The median of the four fingers' lengths, so that one finger that is elsewhere does not count; NaN if there is one.
double size_m_of(const TrackedHand& hand) {
  std::array<double, fingers - 1> lengths_m{};
  for (std::size_t f = 1; f < fingers; ++f)
    lengths_m[f - 1] = length_m(hand, f);
  if (!std::ranges::all_of(lengths_m, [](double length) { return std::isfinite(length); })) return std::nan("");
  std::ranges::sort(lengths_m);
  return 0.5 * (lengths_m[1] + lengths_m[2]);
}

bool has_radii(const TrackedHand& hand) {
  if (!std::ranges::all_of(hand.radii_m, [](double radius_m) { return any_radius_m.hold(radius_m); })) return false;
  std::array<double, joint_count> radii_m{};
  std::size_t count = 0;
  for (std::size_t f = 0; f < fingers; ++f) {
    for (std::size_t j = finger_joints[f].first + 1; j <= tip_of(f); ++j)
      radii_m[count++] = hand.radii_m[j];
  }
  const std::span<double> all(radii_m.data(), count);
  std::ranges::nth_element(all, all.begin() + static_cast<std::ptrdiff_t>(count / 2));
  const double median_m = all[count / 2];
  return std::ranges::all_of(
      all, [&](double radius_m) { return finger_radius_m.hold(radius_m) && radius_part.hold(radius_m / median_m); });
}

/// The bone that begins at `joint`, and the next one.
bool bends(const TrackedHand& hand, std::size_t joint) {
  const double both_m = bone_m(hand, joint) + bone_m(hand, joint + 1);
  return bend.hold(glm::distance(hand.joints[joint], hand.joints[joint + 2]) / both_m);
}

bool has_finger(const TrackedHand& hand, std::size_t finger, double size_m) {
  const double finger_m = length_m(hand, finger);
  if (!(finger == 0 ? thumb_length : finger_length).hold(finger_m / size_m)) return false;
  for (std::size_t j = root_of(finger); j < tip_of(finger); ++j) {
    if (!bone_part.hold(bone_m(hand, j) / finger_m)) return false;
  }
  const std::size_t first = finger_joints[finger].first;
  if (finger > 0 && !metacarpal_length.hold(bone_m(hand, first) / size_m)) return false;
  if (!bends(hand, first) || !bends(hand, first + 1)) return false;
  const auto is_near_palm = [&](std::size_t joint) {
    return from_palm.hold(glm::distance(hand.joints[palm_joint], hand.joints[joint]) / size_m);
  };
  return is_near_palm(first) && is_near_palm(first + 1);
}

bool has_palm(const TrackedHand& hand, double size_m) {
  const auto apart_m = [&](std::size_t a, std::size_t b) { return glm::distance(hand.joints[a], hand.joints[b]); };
  const auto metacarpal = [&](std::size_t f) { return hand.joints[root_of(f)] - hand.joints[finger_joints[f].first]; };
  double row_m = 0;
  for (std::size_t f = 1; f < fingers; ++f) {
    const double length_m = apart_m(wrist_joint, root_of(f));
    if (!palm_length.hold(length_m / size_m)) return false;
    if (!palm_root.hold(apart_m(wrist_joint, finger_joints[f].first) / length_m)) return false;
    if (f + 1 == fingers) break;
    const double gap_m = apart_m(root_of(f), root_of(f + 1));
    if (!knuckles_apart.hold(gap_m / size_m)) return false;
    row_m += gap_m;
    const Vec3 one = metacarpal(f), other = metacarpal(f + 1);
    if (!(glm::dot(one, other) >= metacarpals_cosine * glm::length(one) * glm::length(other))) return false;
  }
  const double width_m = apart_m(root_of(1), root_of(fingers - 1));
  return palm_width.hold(width_m / size_m) && knuckle_row.hold(width_m / row_m) &&
         from_palm.hold(apart_m(palm_joint, wrist_joint) / size_m);
}

}  // namespace

std::optional<Misfit> misfit_of(const TrackedHand& hand) {
  if (!has_radii(hand)) return Misfit::radius;
  const double size_m = size_m_of(hand);
  if (!hand_size_m.hold(size_m)) return Misfit::size;
  for (std::size_t f = 0; f < fingers; ++f) {
    if (!has_finger(hand, f, size_m)) return Misfit::shape;
  }
  return has_palm(hand, size_m) ? std::nullopt : std::optional(Misfit::shape);
}

}  // namespace palpa::sensing
