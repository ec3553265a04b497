// How a transducer's sound decreases to the side.
#pragma once

#include <cstddef>
#include <vector>

#include "base/words.hpp"

namespace palpa::array {

/// `omni`: equal in all directions. `piston`: a circular piston in a wall, 2 J1(x) / x with x = k a sin(angle).
/// `t4010a1`: measured on that transducer every 10 degrees from 0 to 90, interpolated by monotone cubics (Fritsch and
/// Butland 1984: slopes are harmonic means; 0 on the axis, that of the last interval at 90 degrees); independent of k
/// and a.
enum class Directivity { omni, piston, t4010a1 };
inline constexpr Word<Directivity> directivity_words[] = {
    {"omni", Directivity::omni}, {"piston", Directivity::piston}, {"t4010a1", Directivity::t4010a1}};

/// Pressure relative to the axis, at the angle whose cosine is given (clamped to -1..1); `ka` is the wave number times
/// the radius. Behind the transducer, neither formula nor table applies; there `piston` and `t4010a1` fall from their
/// value at 90 degrees to 0 at 180 as (1 + cosine)^2, so that a transducer that faces away contributes little.
double directivity(Directivity kind, double cosine, double ka);

/// The solvers use a lookup table: samples at the cosines -1 + 2 i / directivity_steps, i = 0 .. directivity_steps,
/// linearly interpolated. Within 5e-5 of `directivity` for ka up to 10.
inline constexpr std::size_t directivity_steps = 2048;
std::vector<double> directivity_table(Directivity kind, double ka);

}  // namespace palpa::array
