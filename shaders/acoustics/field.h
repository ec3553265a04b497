// Shared by engine/acoustics/field/field_pass.cpp and shaders/acoustics/field.comp.
#ifndef PALPA_SHADERS_FIELD_H
#define PALPA_SHADERS_FIELD_H
#include "shaders/shared/shared.h"
PALPA_SHADER_BEGIN

PALPA_CONST field_group = 32u;  // threads of a workgroup
// Points that a thread keeps in registers: each transducer that it loads serves all of them.
PALPA_CONST field_each = 4u;

PALPA_CONST field_directivity_steps = 2048u;

// Places are in wavelengths, as a multiple of 1/16 plus a rest: differences of the coarse parts are exact.
struct FieldSource {
  vec4 coarse;  // x, y, z; w: real part of its strength
  vec4 fine;    // x, y, z; w: imaginary part
  vec4 axis;    // x, y, z; w unused
};
PALPA_CHECK_SIZE(FieldSource, 48);
PALPA_CHECK_OFFSET(FieldSource, axis, 32);

struct FieldPoint {
  vec4 coarse;  // x, y, z; w unused
  vec4 fine;
};
PALPA_CHECK_SIZE(FieldPoint, 32);
PALPA_CHECK_OFFSET(FieldPoint, fine, 16);

// The directivity from cosine -1 + 2 i / steps on: value + rise * (0..1).
struct FieldStep {
  float value;
  float rise;
};
PALPA_CHECK_SIZE(FieldStep, 8);

struct FieldPressure {
  float re;
  float im;
};
PALPA_CHECK_SIZE(FieldPressure, 8);

struct FieldPush {
  uint points;
  uint sources;
  float nearest;   // the transducers' radius, wavelengths
  float halvings;  // of the amplitude, per wavelength travelled
};
PALPA_CHECK_SIZE(FieldPush, 16);
PALPA_CHECK_OFFSET(FieldPush, halvings, 12);

PALPA_SHADER_END
#endif
