// Foci of every finger by the sectors of its cross-section, Eq. (5)-(7), or at equal arc lengths along it.
#pragma once

#include <cstdint>
#include <span>

#include "touch/types.hpp"

namespace palpa::touch {

/// Fills the foci of the first `finger_count` fingers from contacts and sections. `of_solid` is foci_of_solids(); a
/// solid beyond its end has the parameters' N. Sums are in integers, and do not depend on the order of the contacts.
void find_foci(const FingerOptions& parameters, std::span<const std::uint32_t> of_solid, Touch& out);

}  // namespace palpa::touch
