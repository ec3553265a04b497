#include "array/drive_options.hpp"

#include <algorithm>
#include <cmath>

namespace palpa::array {

bool drivable(const SlotFocus& focus) {
  const Vec3& p = focus.position;
  // Written so that NaN fails the test.
  return std::abs(p.x) <= 100 && std::abs(p.y) <= 100 && std::abs(p.z) <= 100;
}

float gain_of(const SlotFocus& focus) {
  return focus.gain > 0 ? std::min(1.0f, focus.gain) : 0.0f;
}

}  // namespace palpa::array
