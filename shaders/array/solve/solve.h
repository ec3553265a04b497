// Shared by engine/array/solver_pass.cpp and shaders/array/solve/solve_*.comp.
#ifndef PALPA_SHADERS_SOLVE_H
#define PALPA_SHADERS_SOLVE_H
#include "shaders/array/drive/drive.h"
#include "shaders/shared/shared.h"
PALPA_SHADER_BEGIN

// Threads of a workgroup. The kernels for few foci use fewer. If one thread computes a slot, a last, nearly empty
// workgroup costs as much as a full one. If steps wait for each other, a software device pays for each thread that
// waits.
PALPA_CONST solve_group = 32u;
PALPA_CONST solve_weights_few_group = 8u;
PALPA_CONST solve_phases_group = 16u;
PALPA_CONST solve_most_foci = 64u;
// Slots of up to this many foci are solved with all foci in registers, by kernels of that size; larger slots are
// computed tile by tile.
PALPA_CONST solve_hand_foci = 5u;
PALPA_CONST solve_finger_foci = 10u;
PALPA_CONST solve_tile = 5u;         // rows and columns of a matrix' tile
PALPA_CONST solve_greedy_few = 16u;  // up to this many foci, the smaller of greedy's two kernels computes the slot

// Contents of the buffers that drive.h does not describe. The solvers write the weights.
//   axes         vec4[], as texels: unit vector, w unused
//   directivity  uint[solve_directivity_steps], as texels: two neighbouring samples, 16 bits each
//   matrices     vec2[]: of slot s, count * count from its `solved`: [column * count + row]; overwritten by
//                solve_eigenvalue

PALPA_CONST solve_directivity_steps = 2048u;
PALPA_CONST solve_phases = 16u;   // greedy's
PALPA_CONST solve_turns = 8192u;  // greedy's in one dispatch

// From gs_pat.hpp, even_out.hpp, even_phases.hpp and eigenvalue.hpp, with the same names.
PALPA_CONST solve_starts = 8u;
PALPA_CONST solve_sounds = 4u;
PALPA_CONST solve_climb = 20u;
PALPA_CONST solve_look = 3u;
PALPA_CONST solve_tries = 40u;
PALPA_CONST solve_bounded_tries = 8u;
PALPA_CONST solve_raises = 6u;
PALPA_CONST_FLOAT solve_most_help = 4.0f;
PALPA_CONST_FLOAT solve_hears = 0.2f;
PALPA_CONST_FLOAT solve_same = 0.9f;
PALPA_CONST_FLOAT solve_better = 1.005f;
PALPA_CONST_FLOAT solve_miss = 0.003f;
PALPA_CONST_FLOAT solve_fill = 2.0f;
PALPA_CONST_FLOAT solve_uneven = 0.15f;
PALPA_CONST_FLOAT solve_push = 0.1f;
PALPA_CONST_FLOAT solve_keep = 0.95f;
PALPA_CONST_FLOAT solve_damping = 0.03f;
PALPA_CONST_FLOAT solve_least_damping = 1e-4f;
PALPA_CONST_FLOAT solve_most_damping = 1e4f;
PALPA_CONST_FLOAT solve_less = 0.3f;
PALPA_CONST_FLOAT solve_more = 4.0f;
PALPA_CONST_FLOAT solve_ridge = 0.01f;

struct SolvePush {
  uint transducers;
  uint slots;
  uint weighting;   // as in drive.h
  uint constraint;  // as in drive.h
  float nearest;    // in wavelengths: a nearer transducer counts as this far away
  uint stride;      // greedy_stride
  uint steps;       // gs_pat_steps, eigenvalue_steps; of back-propagation on the matrix
  uint refinings;   // gs_pat_refinings
  float most_weight;
  float still;
  uint begin;  // greedy: the turns of this dispatch,
  uint end;    // up to but not including this one,
  uint next;   // and the transducer whose turn comes first
  uint tries;  // gs_pat_most_tries
};
PALPA_CHECK_SIZE(SolvePush, 56);
PALPA_CHECK_OFFSET(SolvePush, nearest, 16);
PALPA_CHECK_OFFSET(SolvePush, most_weight, 32);
PALPA_CHECK_OFFSET(SolvePush, tries, 52);

PALPA_SHADER_END
#endif
