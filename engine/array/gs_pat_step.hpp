// One step of gs_pat.hpp, and what it goes by.
#pragma once

#include <complex>
#include <cstdint>
#include <span>
#include <vector>

#include "array/transfer.hpp"

namespace palpa::array {

/// What part of full loudness each focus may claim.
void find_claims(const FocusMatrix& matrix, std::vector<double>& claims);

/// Fills `factors`: phases of what the transducers of start number `start` sound like, weights as if each focus sounded
/// alone. The first start has the first transducer; each of the others gs_pat_sounds, from all over the layout, no two
/// the same ones.
void gs_pat_start(const FocusMatrix& matrix, const Columns& columns, std::uint32_t start,
                  std::span<const double> claims, std::span<std::complex<double>> factors);

struct GsPatGoal {
  double level = 0;  ///< L; 0: what the foci are now
  double sum = 0;    ///< what the magnitudes add up to afterwards; 0: as it comes
};

/// Moves the factors towards t_j L. Returns how far the farthest moved.
double gs_pat_step(std::span<const std::complex<double>> pressure, std::span<const double> targets,
                   const GsPatGoal& goal, std::span<std::complex<double>> factors);

}  // namespace palpa::array
