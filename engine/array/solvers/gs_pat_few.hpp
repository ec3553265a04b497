// gs_pat for slots of few foci at any distance (gs_pat.hpp).
#pragma once

#include "array/solvers/gs_pat.hpp"

namespace palpa::array {

/// The same as gs_pat, for at most gs_pat_few foci. `scratch` must have the claims (find_claims) and room for all foci.
void solve_few(const FocusMatrix& matrix, const Columns& columns, std::span<const double> gains, Constraint constraint,
               std::span<FocusWeight> weights, GsPatScratch& scratch);

/// Fills the targets: gains times claims, but at least as loud as a coinciding focus requires.
void find_targets(const FocusMatrix& matrix, std::span<const double> gains, GsPatScratch& scratch);

/// Scales the factors so that sums are gs_pat_fill times as large as those of foci that do not hear each other.
void fill_up(const FocusMatrix& matrix, std::span<const double> gains, GsPatScratch& scratch);

}  // namespace palpa::array
