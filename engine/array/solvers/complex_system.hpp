// Small systems of complex equations.
#pragma once

#include <complex>
#include <span>

namespace palpa::array {

/// Solves the system in place by elimination, with the largest entry of each column as its pivot; `rest` becomes the
/// solution. Rows of `rest.size()`. An unknown without a pivot becomes 0.
void solve_complex(std::span<std::complex<double>> system, std::span<std::complex<double>> rest);

}  // namespace palpa::array
