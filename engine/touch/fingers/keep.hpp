// What is kept of a frame's fingers, so that the next frame knows them.
#pragma once

#include <cstdint>
#include <vector>

#include "touch/fingers/admit.hpp"
#include "touch/fingers/follow.hpp"
#include "touch/fingers/known.hpp"
#include "touch/fingers/known_labels.hpp"
#include "touch/types.hpp"

namespace palpa::touch {

/// The fingers of `touch`, whose skin is given, become the known fingers. Sets Finger::holds.
/// `tracks` are those of this frame, the fingers' first; `continuations` come from admit_fingers(). The islands of the
/// table stay.
void keep_fingers(const FingerSkins& skins, const FingerOptions& parameters, const Tracks& tracks,
                  const Continuations& continuations, const HysteresisRules& rules, Touch& touch, KnownFingers& table);

/// Removes the contacts that are beyond the shell's edges from the touch and from its fingers. `scratch` keeps its
/// storage.
void leave_out_beyond(Touch& touch, std::vector<std::uint32_t>& scratch);

}  // namespace palpa::touch
