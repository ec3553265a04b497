// The maximum cost of one point's lookup on the device.
#pragma once

#include <cstdint>

#include "touch/contacts/prepared_solids.hpp"

namespace palpa::touch {

/// An upper bound of the iterations that the loops of contacts_walk.glsl take for one point with these parameters,
/// whichever points its neighbours in the group look up. It counts some iterations for every solid, plus the longest
/// lists of the sixteen solids with the longest lists, because the boxes of more than sixteen solids hardly ever meet
/// in one place. Looks at every cell of every solid.
std::uint32_t contact_iterations(const PreparedSolids& solids, const FingerOptions& parameters);

}  // namespace palpa::touch
