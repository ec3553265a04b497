// Shared by engine/array/drive_pass.cpp and shaders/array/drive/drive_*.comp. The solvers' shaders
// (solve.h) use its structs, too.
#ifndef PALPA_SHADERS_DRIVE_H
#define PALPA_SHADERS_DRIVE_H
#include "shaders/shared/shared.h"
PALPA_SHADER_BEGIN

PALPA_CONST drive_group = 32u;  // threads of a workgroup, in all drive_*.comp
// Transducers that a thread of drive_focus keeps in registers, and slots that it computes for them: the data that it
// loads for a slot serves all these transducers.
PALPA_CONST drive_each = 8u;
PALPA_CONST drive_slots_per_group = 64u;
PALPA_CONST drive_sum_each = 4u;  // the same for drive_sum

// Contents of the buffers, also for the solvers' kernels. Transducers, foci, slots and weights are read as texels of 16
// bytes.
//   transducers  DrivePoint[]
//   foci         DriveFocus[]
//   slots        DriveSlot[]
//   drives       DriveOut[]: slots x transducers
//   weights      vec4[]: per focus its plain and its heard factor

// Weightings and constraints, as in engine/array/drive.hpp.
PALPA_CONST drive_by_distance = 0u;
PALPA_CONST drive_by_nothing = 1u;
PALPA_CONST drive_normalise = 0u;
PALPA_CONST drive_uniform = 1u;
PALPA_CONST drive_clamp = 2u;

PALPA_CONST drive_unsolved = 0xffffffffu;
PALPA_CONST drive_given = 0xfffffffeu;

// A place in wavelengths, as a multiple of 1/16 plus a rest. The squared difference of two such coarse parts is exact
// in float up to 256 wavelengths, so a phase hundreds of turns away is as exact as a near one.
struct DrivePoint {
  vec4 coarse;  // x, y, z; w unused
  vec4 fine;    // x, y, z in -1/32..1/32; w unused
};
PALPA_CHECK_SIZE(DrivePoint, 32);
PALPA_CHECK_OFFSET(DrivePoint, fine, 16);

struct DriveFocus {
  vec4 coarse;  // x, y, z; w: 1 / distance of the farthest transducer, in wavelengths; 0: every transducer is at the
                // focus
  vec4 fine;    // x, y, z; w: gain relative to the slot's, 0..1
};
PALPA_CHECK_SIZE(DriveFocus, 32);
PALPA_CHECK_OFFSET(DriveFocus, fine, 16);

struct DriveSlot {
  uint first;   // of its foci
  uint count;   // 0: silence
  float gain;   // shared by all of its foci, 0..1
  uint solved;  // drive_unsolved: the plain sum of its foci; drive_given: their factors are given; otherwise where its
                // matrix begins, in entries; with greedy, any other value
};
PALPA_CHECK_SIZE(DriveSlot, 16);
PALPA_CHECK_OFFSET(DriveSlot, gain, 8);

struct DriveOut {
  float amplitude;
  float phase;
};
PALPA_CHECK_SIZE(DriveOut, 8);
PALPA_CHECK_OFFSET(DriveOut, phase, 4);

struct DrivePush {
  uint transducers;
  uint slots;
  uint weighting;
  uint constraint;
  // Under `uniform` and `clamp`, in slots of at most this many foci with complex factors, the transducers' phases turn
  // away from those of their sums. The angle, in turns, is kept in the drive's phase until the phase is written there.
  uint turned_foci;
};
PALPA_CHECK_SIZE(DrivePush, 20);
PALPA_CHECK_OFFSET(DrivePush, constraint, 12);

PALPA_SHADER_END
#endif
