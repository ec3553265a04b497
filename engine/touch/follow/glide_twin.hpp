// Foci that do not jump from frame to frame. The rules are in docs/touch.md.
#pragma once

#include <vector>

#include "shaders/touch/follow/glide.h"
#include "touch/follow/follow_twin.hpp"
#include "touch/types.hpp"

namespace palpa::touch {

/// What is kept of fingers' foci, each at its track's home. One for each stream of frames.
struct Homes {
  std::vector<shader::Home> homes{shader::follow_most_tracks};
};

/// C++ twin of GlidePass. `tracks` are those that follow_fingers has left for this frame, whose foci are those of
/// find_foci; each gets the place that it is played at. Same single-precision arithmetic as in the pass. Allocates
/// nothing.
void glide_foci(const Tracks& tracks, Homes& homes, Touch& touch);

}  // namespace palpa::touch
