// Slots with more than most_solved_foci foci whose fingers request pressures.
//
// As many fingers as fit are solved together as one part, with the real matrix of their foci, then the next part. The
// influence of one part on another is not solved, but evaluated afterwards over the whole array. A finger with a focus
// that is louder than the finger's request at its crest is lowered as a whole. If that does not suffice, because the
// sound of other fingers reaches the focus, the whole slot is lowered. So no focus is louder than requested; some are
// quieter. Memory grows linearly with the number of foci, not with its square.
#pragma once

#include <complex>
#include <span>
#include <vector>

#include "array/drive_options.hpp"
#include "array/field/transfer.hpp"
#include "array/layouts/layout.hpp"

namespace palpa::array {

/// One past the last of the foci that are solved together with focus `first`, the first of its part. A slot of at most
/// most_solved_foci foci is one part. Otherwise, a part consists of as many voices as possible with at most
/// most_solved_foci foci in total.
std::size_t part_end(std::span<const SlotFocus> foci, std::size_t first);

/// Fills `heard`, one per focus, with the sum of factor times q_j over the whole array at that focus, in 1/m. Uses no
/// more of `columns` than most_solved_foci foci need.
void hear_all(const Transfer& transfer, const Layout& layout, std::span<const FocusSource> sources, Weighting weighting,
              std::span<const std::complex<double>> factors, Columns& columns, std::span<std::complex<double>> heard);

/// Lowers a slot's factors until no focus exceeds its most_pa. `heard` is as filled by hear_all, before and after.
void keep_below(const Transfer& transfer, const Layout& layout, std::span<const SlotFocus> foci,
                std::span<const FocusSource> sources, Weighting weighting, std::span<std::complex<double>> factors,
                Columns& columns, std::span<std::complex<double>> heard);

/// A focus without a request must not make other foci louder. If the array does not resolve it from a focus with a
/// request (gs_pat_crowded), its target decreases the more the two overlap, down to the target of the other focus where
/// both are at the same place. Lowers the `targets` of foci without most_pa. Foci with a request are ignored if their
/// target is 0.
void cap_unasked(const FocusMatrix& matrix, std::span<const SlotFocus> foci, std::span<double> targets);

/// A focus without a request needs no target: it becomes 0, so that the focus is not corrected while others are.
void release_unasked(std::span<const SlotFocus> foci, std::span<double> targets);

}  // namespace palpa::array
