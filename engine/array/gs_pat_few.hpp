// gs_pat for slots of few foci at any distance (gs_pat.hpp).
#pragma once

#include "array/gs_pat.hpp"

namespace palpa::array {

/// As gs_pat, for at most gs_pat_few foci; expects claims and room for all foci in `scratch`.
void solve_few(const FocusMatrix& matrix, const Columns& columns, std::span<const double> gains, Constraint constraint,
               std::span<FocusWeight> weights, GsPatScratch& scratch);

}  // namespace palpa::array
