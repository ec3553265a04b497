// A sine as a polynomial, so that every device and the host agree; a device's own may differ by 2^-11.
#ifndef PALPA_SHADERS_SINE_OF_TURNS_H
#define PALPA_SHADERS_SINE_OF_TURNS_H
#include "shaders/shared/shared.h"
PALPA_SHADER_BEGIN

// sin(2 pi x) for x in -1/4..1/4, within 1e-7.
PALPA_FN_INLINED float sine_of_turns(float x) {
  const float y = x * 6.2831853f;
  const float s = y * y;
  float series = -2.5052108e-8f;
  series = series * s + 2.7557319e-6f;
  series = series * s - 1.9841270e-4f;
  series = series * s + 8.3333333e-3f;
  series = series * s - 1.6666667e-1f;
  series = series * s + 1.0f;
  return y * series;
}

PALPA_SHADER_END
#endif
