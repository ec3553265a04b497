// Finds foci that an array cannot distinguish.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "array/drive_options.hpp"
#include "array/layouts/layout.hpp"

namespace palpa::array {

/// Two foci, and the share of either one's sound that is heard at the other.
struct FocusPair {
  std::size_t first = 0, second = 0;
  double part = 0;  ///< 0..1
};

/// The pairs that are closer than the array resolves: heard_part is gs_pat_crowded or more. In order; empty for one
/// focus, and for more than most_solved_foci. Foci that are not drivable belong to no pair. Only the options
/// medium, weighting, directivity and transfer matter.
std::vector<FocusPair> unresolved_pairs(const Layout& layout, std::span<const SlotFocus> foci,
                                        const DriveOptions& options);

}  // namespace palpa::array
