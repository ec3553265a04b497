// How summed amplitudes are brought into 0..1.
#pragma once

namespace palpa::array {

/// `normalise`: the largest becomes 1. `uniform`: every transducer at 1. `clamp`: what exceeds 1 becomes 1.
enum class Constraint { normalise, uniform, clamp };

}  // namespace palpa::array
