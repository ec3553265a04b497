// The motion of a finger's skin, apart from contacts that join it or leave it.
#pragma once

#include <span>

#include "touch/fingers/exact.hpp"

namespace palpa::touch {

/// How far the centroid of a finger's contacts has moved because contacts joined it or left it, in metres. `before` and
/// `now` are the finger's contacts in two frames, between which it was expected to move by `expected`. A contact that
/// has none of the other frame within 6 mm of it has joined or left. Zero if no contact joined or left, if most of
/// both did, or if the contacts match once moved as their centroid moved.
glm::vec3 moved_by_members(std::span<const glm::vec3> before, std::span<const glm::vec3> now,
                           const glm::vec3& expected);

}  // namespace palpa::touch
