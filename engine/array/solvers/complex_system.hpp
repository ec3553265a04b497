// Small systems of equations.
#pragma once

#include <complex>
#include <initializer_list>
#include <span>

namespace palpa::array {

/// Solves the system in place by elimination, with the largest entry of each column as its pivot; `rest` becomes the
/// solution. Rows of `rest.size()`. An unknown without a pivot becomes 0.
void solve_complex(std::span<std::complex<double>> system, std::span<std::complex<double>> rest);

/// Solves a symmetric positive-definite system in place, for one or several right-hand sides of the same size, which
/// become the solutions.
void solve_positive(std::span<double> system, std::initializer_list<std::span<double>> rests);

}  // namespace palpa::array
