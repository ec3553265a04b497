// What a camera sees along the skin from one contact to another: whether there is a valley between the two, as between
// two fingers.
#pragma once

#include <cstddef>

#include "touch/fingers/sight.hpp"

namespace palpa::touch {

/// A place on the skin, as one camera sees it.
struct SeenSample {
  glm::vec3 at;  ///< camera coordinates
  int u, v;
  bool seen;  ///< not hidden by nearer skin, and not out of the picture
};
SeenSample seen_sample(const Sight& sight, std::size_t camera, const glm::vec3& place);

/// Whether the skin falls and rises again along the straight line of pixels between two samples that the camera sees
/// (docs/touch.md has the depth of a valley).
bool finds_valley(const Sight& sight, std::size_t camera, const SeenSample& a, const SeenSample& b);

}  // namespace palpa::touch
