// Slots of more foci than most_solved_foci whose fingers ask for pressures.
//
// As many fingers as fit are solved together by the real matrix of their foci, and so are the next; what one part does
// to another is not solved, but heard afterwards over the whole array: a finger with a focus that is louder than its
// finger asks at its crest is lowered as a whole, and where that does not suffice, since it is others that are heard
// there, all of the slot is. So no focus is louder than asked; some are quieter. Memory is in proportion to the foci,
// not to their square.
#pragma once

#include <complex>
#include <span>
#include <vector>

#include "array/drive.hpp"

namespace palpa::array {

/// One past the last of the foci that are solved together with focus `first`, one of the first in its part: all of a
/// slot of at most most_solved_foci; else of as many voices as have no more together.
std::size_t part_end(std::span<const SlotFocus> foci, std::size_t first);

/// Fills `heard`, one per focus, with what the sum of factor times q_j over all of the array gives there, in 1/m. No
/// more of `columns` is used than most_solved_foci foci have.
void hear_all(const Transfer& transfer, const Layout& layout, std::span<const FocusSource> sources, Weighting weighting,
              std::span<const std::complex<double>> factors, Columns& columns, std::span<std::complex<double>> heard);

/// Lowers a slot's factors until no focus has more than its most_pa. `heard` is as hear_all fills it, before and after.
void keep_below(const Transfer& transfer, const Layout& layout, std::span<const SlotFocus> foci,
                std::span<const FocusSource> sources, Weighting weighting, std::span<std::complex<double>> factors,
                Columns& columns, std::span<std::complex<double>> heard);

/// Only who asks may raise others: a focus that asks for nothing, so near to one that asks that the array does not
/// resolve the two (gs_pat_crowded), is to have less and less, and as much where they are one. `targets` of foci
/// without most_pa come down; those that ask and whose target is 0 count for nothing.
void cap_unasked(const FocusMatrix& matrix, std::span<const SlotFocus> foci, std::span<double> targets);

/// Nor does it have to have anything: its target becomes 0, so that it sounds as it comes while others are corrected.
void release_unasked(std::span<const SlotFocus> foci, std::span<double> targets);

}  // namespace palpa::array
