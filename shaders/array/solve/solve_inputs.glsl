// The inputs of every kernel of the solvers: slots and foci, and the transfer between transducers and foci.
#include "shaders/array/solve/solve.h"
#include "shaders/array/drive/drive.h"
#include "shaders/array/drive/drive_inputs.glsl"
#include "shaders/shared/turns.glsl"

layout(push_constant) uniform Push { SolvePush push; };

// This kernel computes slots of at least this many foci.
layout(constant_id = 0) const uint fewest = 2u;
layout(constant_id = 1) const uint most = 64u;

bool solves(DriveSlot slot) { return slot.count >= fewest && slot.count <= most && slot.solved != drive_unsolved; }

#include "shaders/array/drive/transfer_free.glsl"
