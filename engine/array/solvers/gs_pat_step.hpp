// One step of gs_pat.hpp, and its targets.
#pragma once

#include <complex>
#include <cstdint>
#include <span>
#include <vector>

#include "array/field/transfer.hpp"

namespace palpa::array {

/// The share of full loudness that each focus may claim.
void find_claims(const FocusMatrix& matrix, std::vector<double>& claims);

/// Fills `factors`: the phases are those of a sound that converges on the transducers of start number `start`, the
/// weights are as if each focus sounded alone. The first start uses the first transducer. Each of the others uses
/// gs_pat_sounds transducers from all over the layout, and no two starts use the same ones.
void gs_pat_start(const FocusMatrix& matrix, const Columns& columns, std::uint32_t start,
                  std::span<const double> claims, std::span<std::complex<double>> factors);

struct GsPatGoal {
  double level = 0;  ///< L; 0: the current level of the foci
  double sum = 0;    ///< sum of the magnitudes afterwards; 0: not fixed
};

/// Moves the factors towards t_j L. Returns the largest change.
double gs_pat_step(std::span<const std::complex<double>> pressure, std::span<const double> targets,
                   const GsPatGoal& goal, std::span<std::complex<double>> factors);

/// At most `steps` of these steps, with the pressure that the factors give, until no factor changes any more.
/// `pressure` is scratch.
void gs_pat_climb_to(const FocusMatrix& matrix, std::span<const double> targets, const GsPatGoal& goal,
                     std::uint32_t steps, std::span<std::complex<double>> factors,
                     std::vector<std::complex<double>>& pressure);

}  // namespace palpa::array
