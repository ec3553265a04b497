// Foci are smoothed so that they do not jump from frame to frame. The rules are in docs/touch.md.
#pragma once

#include <vector>

#include "touch/fingers/follow.hpp"
#include "touch/fingers/glide_math.hpp"
#include "touch/types.hpp"

namespace palpa::touch {

/// The data kept of fingers' foci, each at its track's home. One object for each stream of frames.
struct Homes {
  std::vector<Home> homes{follow_most_tracks};
};

/// `tracks` are the result of follow_fingers() for this frame, and the foci are the result of
/// find_foci(). Each focus gets the place where it is played. Allocates nothing.
void glide_foci(const Tracks& tracks, Homes& homes, Touch& touch);

}  // namespace palpa::touch
