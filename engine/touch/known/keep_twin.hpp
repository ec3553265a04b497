// What is kept of a frame's fingers, so that the next frame knows them.
#pragma once

#include "shaders/touch/known/known.h"
#include "touch/bridge/sight.hpp"
#include "touch/follow/follow_twin.hpp"
#include "touch/known/admit_twin.hpp"
#include "touch/types.hpp"

namespace palpa::touch {

/// C++ twin of the second part of KnownPass: the fingers of `touch` become the known fingers; sets Finger::holds.
/// `tracks` are those of this frame, the fingers' first; `claims` come from admit_fingers(). The islands of the table
/// stay. `rules`: bits of known.h.
void keep_fingers(const Sight& sight, const Parameters& parameters, const Tracks& tracks, const ClaimList& claims,
                  std::uint32_t rules, Touch& touch, shader::KnownTable& table);

/// Removes the contacts that are beyond the shell's edges from the touch and from its fingers.
void leave_out_beyond(Touch& touch);

}  // namespace palpa::touch
