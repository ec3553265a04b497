// Cross-sections of every finger, Eq. (2)-(4).
#pragma once

#include <vector>

#include "touch/fingers/sections_math.hpp"
#include "touch/types.hpp"

namespace palpa::touch {

/// The origin of a finger's contacts, which is its first contact. With relative positions, the digits of single
/// precision resolve the finger's own size.
struct LocalOrigin {
  Float3 origin{}, mean{};
  Float3 from_centroid(const glm::vec3& position) const {
    return minus(minus({position.x, position.y, position.z}, origin), mean);
  }
};
LocalOrigin local_origin(const Finger& finger, const std::vector<Contact>& contacts);

/// Fills section and point_like of the first `finger_count` fingers from their contacts, and numbers their ids in
/// order. Sums are compensated, in single precision.
void find_sections(Touch& out);

}  // namespace palpa::touch
