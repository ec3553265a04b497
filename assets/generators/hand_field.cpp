#include "assets/generators/hand_field.hpp"

#include <algorithm>
#include <cmath>

namespace palpa::assets {
namespace {

constexpr double kPalmBlend = 10e-3;  ///< width over which two parts of the palm blend
constexpr double kJointBlend = 3e-3;  ///< the bones of one finger
constexpr double kRootBlend = 7e-3;   ///< a finger's root and the palm
constexpr double kTouchBlend = 1e-3;  ///< parts that only lie close to each other
constexpr double kHalfGap = 1.3e-3;   ///< kept between parts that a pose presses together; half of the gap
constexpr double kRootFade = 10e-3;   ///< over which a finger separates from the palm's flesh
constexpr double kNever = 30e-3;      ///< moves a cut out of the way
constexpr double kFar = 20e-3;        ///< no gap this far from a digit

/// The smaller of two distances, rounded off if they differ by less than `width` (cubic, so curvature is continuous).
double soft_min(double p, double q, double width) {
  const double h = std::max(width - std::fabs(p - q), 0.0) / width;
  return std::min(p, q) - h * h * h * width / 6.0;
}

double soft_max(double p, double q, double width) {
  return -soft_min(-p, -q, width);
}

struct DigitDistance {
  double skin;  ///< to the whole digit
  double root;  ///< 1 at its root, 0 from the middle joint on
};

DigitDistance distance_to(const Digit& digit, const Vec3& point) {
  const Bone& first = digit.bones[0];
  const double to_first = distance(first, point);
  double skin = to_first, beyond = 1.0;
  for (std::size_t i = 1; i < digit.bones.size(); ++i) {
    const double d = distance(digit.bones[i], point);
    beyond = std::min(beyond, d);
    skin = soft_min(skin, d, kJointBlend);
  }
  const Bone base{first.a, first.a + (first.b - first.a) * 0.5, first.radius_a,
                  first.radius_a + (first.radius_b - first.radius_a) * 0.5};
  return {skin, std::clamp(0.5 + (beyond - distance(base, point)) / kRootFade, 0.0, 1.0)};
}

double joined(double body, const DigitDistance& digit) {
  return soft_min(body, digit.skin, kTouchBlend + (kRootBlend - kTouchBlend) * digit.root);
}

}  // namespace

double HandField::operator()(const Vec3& point) const {
  double palm = distance(bones_.palm[0], point);
  for (std::size_t i = 1; i < bones_.palm.size(); ++i)
    palm = soft_min(palm, distance(bones_.palm[i], point), kPalmBlend);

  std::array<DigitDistance, 5> digits{};
  for (int i = 0; i < 5; ++i)
    digits[i] = distance_to(bones_.digits[i], point);

  double all = palm;
  for (const DigitDistance& digit : digits)
    all = joined(all, digit);
  // Where a digit, except its root, presses against the rest, both stop short of the surface midway between them. This
  // is the last step, so that nothing blends into the gap.
  for (int i = 0; i < 5; ++i) {
    if (digits[i].skin > kFar) continue;
    double rest = palm;
    for (int j = 0; j < 5; ++j) {
      if (j != i) rest = joined(rest, digits[j]);
    }
    const double gap = kHalfGap - 0.5 * std::fabs(digits[i].skin - rest) - kNever * digits[i].root;
    all = soft_max(all, gap, kTouchBlend);
  }
  return all;
}

Box HandField::bounds() const {
  Box box;
  const auto add = [&](const Bone& bone) {
    const Vec3 margin(std::max(bone.radius_a, bone.radius_b) + 6e-3);
    for (const Vec3& end : {bone.a, bone.b}) {
      box.add(end - margin);
      box.add(end + margin);
    }
  };
  for (const Bone& bone : bones_.palm)
    add(bone);
  for (const Digit& digit : bones_.digits) {
    for (const Bone& bone : digit.bones)
      add(bone);
  }
  return box;
}

}  // namespace palpa::assets
