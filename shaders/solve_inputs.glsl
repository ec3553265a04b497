// What every kernel of the solvers reads: slots and foci, and the transfer between transducers and foci.
#include "solve.h"
#include "drive.h"
#include "drive_inputs.glsl"
#include "turns.glsl"

layout(push_constant) uniform Push { SolvePush push; };

// Slots with that many foci are this kernel's.
layout(constant_id = 0) const uint fewest = 2u;
layout(constant_id = 1) const uint most = 64u;

bool solves(DriveSlot slot) { return slot.count >= fewest && slot.count <= most && slot.solved != drive_unsolved; }

#include "transfer_free.glsl"
