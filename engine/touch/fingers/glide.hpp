// Foci are smoothed so that they do not jump from frame to frame. The rules are in docs/touch-frames.md.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "shaders/shared/shared.h"
#include "touch/fingers/follow.hpp"
#include "touch/types.hpp"

namespace palpa::touch {

/// A focus as it was played.
struct GlidingFocus {
  float x;  // world
  float y;
  float z;
  std::uint32_t empty_us;  // time since its sector has had contacts
  float speed_x;           // m/s, smoothed: speed of its sector's target relative to the finger
  float speed_y;
  float speed_z;
};

/// The data kept of a finger's foci from frame to frame, at its track's home.
struct Home {
  shader::vec4 centre;    // of the contacts when it was last seen
  shader::vec4 velocity;  // m/s
  shader::vec4 axis1;
  shader::vec4 axis3;
  std::uint32_t foci;
  std::array<GlidingFocus, max_foci> focus;
};

/// The data kept of fingers' foci, each at its track's home. One object for each stream of frames.
struct Homes {
  std::vector<Home> homes{follow_most_tracks};
};

/// `tracks` are the result of follow_fingers() for this frame, and the foci are the result of
/// find_foci(). Each focus gets the place where it is played. Allocates nothing.
void glide_foci(const Tracks& tracks, Homes& homes, Touch& touch);

}  // namespace palpa::touch
