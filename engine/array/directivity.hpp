// How a transducer's sound falls off to the side.
#pragma once

#include <cstddef>
#include <vector>

#include "base/words.hpp"

namespace palpa::array {

/// `omni`: alike in all directions. `piston`: a circular piston in a wall, 2 J1(x) / x with x = k a sin(angle).
/// `t4010a1`: as measured on that transducer, every 10 degrees from 0 to 90, monotone cubics between (Fritsch and
/// Carlson); k and a do not matter.
enum class Directivity { omni, piston, t4010a1 };
inline constexpr Word<Directivity> directivity_words[] = {
    {"omni", Directivity::omni}, {"piston", Directivity::piston}, {"t4010a1", Directivity::t4010a1}};

/// Pressure relative to the axis, at the angle whose cosine is given (clamped to -1..1); `ka` is the wave number times
/// the radius. Behind the transducer, where neither formula nor table says anything, `piston` and `t4010a1` fall from
/// their value at 90 degrees to nothing at 180 as (1 + cosine)^2: a transducer that faces away contributes little.
double directivity(Directivity kind, double cosine, double ka);

/// The solvers look directivities up: samples at the cosines -1 + 2 i / table_steps, i = 0 .. table_steps, lines
/// between. Within 5e-5 of `directivity` for ka up to 10.
inline constexpr std::size_t directivity_steps = 2048;
std::vector<double> directivity_table(Directivity kind, double ka);

}  // namespace palpa::array
