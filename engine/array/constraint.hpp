// How summed amplitudes are brought into the range 0..1.
#pragma once

#include "base/words.hpp"

namespace palpa::array {

/// `normalise`: scales so that the largest is 1. `uniform`: sets every transducer to 1. `clamp`: limits each to 1.
enum class Constraint { normalise, uniform, clamp };
inline constexpr Word<Constraint> constraint_words[] = {
    {"normalise", Constraint::normalise}, {"uniform", Constraint::uniform}, {"clamp", Constraint::clamp}};

}  // namespace palpa::array
