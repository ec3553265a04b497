// How summed amplitudes are brought into 0..1.
#pragma once

#include "base/words.hpp"

namespace palpa::array {

/// `normalise`: the largest becomes 1. `uniform`: every transducer at 1. `clamp`: what exceeds 1 becomes 1.
enum class Constraint { normalise, uniform, clamp };
inline constexpr Word<Constraint> constraint_words[] = {
    {"normalise", Constraint::normalise}, {"uniform", Constraint::uniform}, {"clamp", Constraint::clamp}};

}  // namespace palpa::array
