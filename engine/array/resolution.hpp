// Which foci an array can tell apart.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "array/drive.hpp"

namespace palpa::array {

/// Of what either focus gives at its own place so much is heard at the other.
struct FocusPair {
  std::size_t first = 0, second = 0;
  double part = 0;  ///< 0..1
};

/// The pairs that are closer than the array resolves: heard_part is gs_pat_crowded or more. In order; empty for one
/// focus, and for more than most_solved_foci. Foci that are not drivable belong to no pair. Of the options medium,
/// weighting, directivity and transfer count.
std::vector<FocusPair> unresolved_pairs(const Layout& layout, std::span<const SlotFocus> foci,
                                        const DriveOptions& options);

}  // namespace palpa::array
