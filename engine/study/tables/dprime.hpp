// d': how far apart the sensations of two or more alternatives are, in standard deviations of their noise.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "study/tables/confusion.hpp"

namespace palpa::study {

/// The share of correct answers if one of m alternatives is shown and all are equally far apart:
/// integral of phi(x - d) Phi(x)^(m-1) dx. For m >= 2.
double correct_of_dprime(double dprime, std::uint32_t alternatives);

/// d' for m alternatives from the number of correct answers. If all or no answers are correct, half a trial is assumed
/// to be otherwise, because d' would be infinite. Empty without trials and for fewer than two alternatives.
///
/// It assumes that all alternatives are equally far apart. It summarises a table and is no model of it.
std::optional<double> dprime(std::uint64_t correct, std::uint64_t trials, std::uint32_t alternatives);
/// The same for a share, 0 < correct < 1.
double dprime_of_share(double correct, std::uint32_t alternatives);

/// d' of two shapes: z(H) - z(F) of the rows a and b, restricted to the answers a and b, with half a trial added to
/// each of the four cells. Empty if one of the shapes has no such answers.
std::optional<double> dprime_of_pair(const Confusion& table, std::size_t a, std::size_t b);

}  // namespace palpa::study
