// Cross-sections of every finger, Eq. (2)-(4).
#pragma once

#include <vector>

#include "touch/fingers/exact.hpp"
#include "touch/types.hpp"

namespace palpa::touch {

/// The origin of a finger's contacts, which is its first contact. With relative positions, the digits of single
/// precision resolve the finger's own size.
struct LocalOrigin {
  glm::vec3 origin{}, mean{};
  glm::vec3 from_centroid(const glm::vec3& position) const { return position - origin - mean; }
};
LocalOrigin local_origin(const Finger& finger, const std::vector<Contact>& contacts);

/// Fills section and point_like of the first `finger_count` fingers from their contacts, and numbers their ids in
/// order. Sums are compensated, in single precision.
void find_sections(Touch& out);

/// An axis with the sign that it has by itself: it points upwards (y >= 0; if it is within 1e-6 of the horizontal, z,
/// then x, is positive).
glm::vec3 upwards(const glm::vec3& axis);
float largest_component(const glm::vec3& a);

}  // namespace palpa::touch
