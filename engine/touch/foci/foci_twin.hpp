// Foci of every finger, Eq. (5)-(7), or at equal arc lengths along its cross-section, in plain C++.
#pragma once

#include <cstdint>
#include <span>

#include "touch/types.hpp"

namespace palpa::touch {

/// C++ twin of FociPass: fills the foci of the first `finger_count` fingers from contacts and sections. `of_solid` is
/// foci_of_solids(); a solid beyond its end has the parameters' N. Uses the pass's single-precision arithmetic and sums
/// in integers. On a device with exact division and square roots, the results are the same bit for bit. On others,
/// contacts within 1e-5 rad of a sector's border may change sides.
void find_foci(const Parameters& parameters, std::span<const std::uint32_t> of_solid, Touch& out);

}  // namespace palpa::touch
