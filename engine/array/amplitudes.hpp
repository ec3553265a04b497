// How amplitudes are shared out and limited.
#pragma once

#include "base/words.hpp"

namespace palpa::array {

/// How the amplitude of one focus is distributed over the transducers: proportional to distance (1 at the farthest), or
/// uniform.
enum class Weighting { distance, uniform };
inline constexpr Word<Weighting> weighting_words[] = {{"distance", Weighting::distance},
                                                      {"uniform", Weighting::uniform}};

/// How summed amplitudes are brought into the range 0..1. `normalise`: scales so that the largest is 1. `uniform`: sets
/// every transducer to 1. `clamp`: limits each to 1.
enum class Constraint { normalise, uniform, clamp };
inline constexpr Word<Constraint> constraint_words[] = {
    {"normalise", Constraint::normalise}, {"uniform", Constraint::uniform}, {"clamp", Constraint::clamp}};

}  // namespace palpa::array
