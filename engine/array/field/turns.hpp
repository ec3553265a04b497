// Sine and cosine of an angle in turns, in double precision. Written so that compilers vectorise loops over them, with
// the same bits for any width of the vectors.
#pragma once

#include <array>
#include <cmath>
#include <numbers>

namespace palpa::array {

/// Rounds to the nearest whole number, halves to even, within 2^51.
[[gnu::always_inline]] inline double nearest(double x) {
  constexpr double shift = 6755399441055744.0;  // 1.5 * 2^52
  return (x + shift) - shift;
}

/// sin(2 pi x) for x in -1/4..1/4: Taylor's series, with a remainder below 1e-15.
[[gnu::always_inline]] inline double sine_of_turns(double x) {
  constexpr double turn = 2 * std::numbers::pi;
  constexpr std::array<double, 10> inverse_factorials{1.0,
                                                      -1.0 / 6,
                                                      1.0 / 120,
                                                      -1.0 / 5040,
                                                      1.0 / 362880,
                                                      -1.0 / 39916800,
                                                      1.0 / 6227020800,
                                                      -1.0 / 1307674368000,
                                                      1.0 / 355687428096000,
                                                      -1.0 / 121645100408832000};
  const double y = x * turn;
  const double square = y * y;
  double series = inverse_factorials[9];
  for (int i = 8; i >= 0; --i)
    series = series * square + inverse_factorials[i];
  return y * series;
}

/// Cosine and sine of 2 pi `turns`, within 1e-14 turns, for up to 2^51 turns. Each uses the quarter turn on either side
/// of the steep part of its curve.
[[gnu::always_inline]] inline void wave_of_turns(double turns, double& cosine, double& sine) {
  const double part = turns - nearest(turns);
  const double size = std::abs(part);
  cosine = sine_of_turns(0.25 - size);
  sine = std::copysign(sine_of_turns(0.25 - std::abs(0.25 - size)), part);
}

}  // namespace palpa::array
