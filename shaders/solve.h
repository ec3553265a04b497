// Shared by engine/array/solver_pass.cpp and shaders/solve_*.comp.
#ifndef PALPA_SHADERS_SOLVE_H
#define PALPA_SHADERS_SOLVE_H
#include "shared.h"
PALPA_SHADER_BEGIN

PALPA_CONST solve_group = 32u;  // threads of a workgroup, in all
// Foci whose sums a thread keeps in registers while it walks over the transducers: a matrix is made in tiles of so many
// rows and columns.
PALPA_CONST solve_tile = 5u;
PALPA_CONST solve_most_foci = 64u;
PALPA_CONST solve_few = 3u;        // gs_pat_few
PALPA_CONST solve_few_foci = 16u;  // up to so many, greedy's slots run in the smaller of its two kernels

// Bindings of all; not every kernel uses every one.
PALPA_CONST solve_transducers = 0u;  // DrivePoint[]
PALPA_CONST solve_axes = 1u;         // vec4[]: unit vector, w unused
PALPA_CONST solve_foci = 2u;         // DriveFocus[]
PALPA_CONST solve_slots = 3u;        // DriveSlot[]
PALPA_CONST solve_directivity = 4u;  // uint[solve_directivity_steps]: two neighbouring samples, 16 bits each
PALPA_CONST solve_matrices = 5u;     // vec2[]: of slot s, count * count from its `solved`: [column * count + row]
PALPA_CONST solve_weights = 6u;      // vec4[] per focus: plain and heard factor
PALPA_CONST solve_drives = 7u;       // DriveOut[]: slots x transducers
PALPA_CONST solve_buffers = 8u;

PALPA_CONST solve_directivity_steps = 2048u;
PALPA_CONST solve_phases = 16u;   // greedy's
PALPA_CONST solve_turns = 8192u;  // greedy's in one dispatch

struct SolvePush {
  uint transducers;
  uint slots;
  uint weighting;   // as in drive.h
  uint constraint;  // as in drive.h
  float nearest;    // in wavelengths: no transducer counts as nearer
  uint stride;      // greedy's
  uint steps;       // gs_pat_steps
  float most_weight;
  float still;
  uint begin;  // greedy: the turns of this dispatch,
  uint end;    // up to but not including this one,
  uint next;   // and the transducer whose turn comes first
};
PALPA_CHECK_SIZE(SolvePush, 48);
PALPA_CHECK_OFFSET(SolvePush, nearest, 16);
PALPA_CHECK_OFFSET(SolvePush, most_weight, 28);
PALPA_CHECK_OFFSET(SolvePush, next, 44);

PALPA_SHADER_END
#endif
