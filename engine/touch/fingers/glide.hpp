// Foci are smoothed so that they do not jump from frame to frame. The rules are in docs/touch-frames.md.
#pragma once

#include <cstdint>
#include <vector>

#include "base/inplace_vector.hpp"
#include "touch/fingers/follow.hpp"
#include "touch/types.hpp"

namespace palpa::touch {

/// A focus as it was played.
struct GlidingFocus {
  glm::vec3 place{};           ///< world
  std::uint32_t empty_us = 0;  ///< time since its sector has had contacts
  glm::vec3 speed{};           ///< m/s, smoothed: speed of its sector's target relative to the finger
};

/// A finger's foci as they were played when it was last seen.
struct GlidingFoci {
  glm::vec3 centre{};    ///< of the contacts
  glm::vec3 velocity{};  ///< m/s
  glm::mat3 axes{};      ///< columns: w1, w2, w3
  InplaceVector<GlidingFocus, max_foci> foci;
};

/// The foci by the home of their track. One object for each stream of frames.
struct GlideMemory {
  std::vector<GlidingFoci> foci{Tracks::most};
};

/// `tracks` are the result of follow_fingers() for this frame, and the foci are the result of
/// find_foci(). Each focus gets the place where it is played. Allocates nothing.
void glide_foci(const Tracks& tracks, GlideMemory& memory, Touch& touch);

}  // namespace palpa::touch
