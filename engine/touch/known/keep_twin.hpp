// What is kept of a frame's fingers, so that the next frame knows them.
#pragma once

#include "shaders/touch/known/known.h"
#include "touch/bridge/sight.hpp"
#include "touch/follow/follow_twin.hpp"
#include "touch/known/admit_twin.hpp"
#include "touch/types.hpp"

namespace palpa::touch {

/// C++ twin of the second part of KnownPass: the fingers of `touch` become the known fingers. `tracks` are those of
/// this frame, the fingers' first; `claims` come from admit_fingers(). The islands of the table stay.
void keep_fingers(const Sight& sight, const Parameters& parameters, const Tracks& tracks, const ClaimList& claims,
                  const Touch& touch, shader::KnownTable& table);

}  // namespace palpa::touch
