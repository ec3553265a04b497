// Cross-sections of every finger, Eq. (2)-(4), in plain C++.
#pragma once

#include <vector>

#include "shaders/touch/sections/sections_math.h"
#include "touch/types.hpp"

namespace palpa::touch {

/// A finger's contacts relative to its first one: the digits of single precision go to the finger's own size.
struct LocalOrigin {
  shader::Float3 origin{}, mean{};
  shader::Float3 from_centroid(const glm::vec3& position) const {
    return minus(minus({position.x, position.y, position.z}, origin), mean);
  }
};
LocalOrigin local_origin(const Finger& finger, const std::vector<Contact>& contacts);

/// C++ twin of SectionsPass: fills section and point_like of the first `finger_count` fingers from their contacts, and
/// numbers their ids in order. Sums run in the pass's order with the same single-precision arithmetic: where a device
/// divides and takes roots exactly, results are the same bit for bit; elsewhere they differ by some units in the last
/// place.
void find_sections(Touch& out);

}  // namespace palpa::touch
