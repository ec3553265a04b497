// What looking one point up costs the device at most.
#pragma once

#include <cstdint>

#include "touch/contacts/prepared_solids.hpp"

namespace palpa::touch {

/// A bound of the iterations that the loops of contacts_walk.glsl take for one point with these parameters, whichever
/// points its neighbours in the group look up: some for every solid, and the longest lists of the sixteen solids whose
/// lists are the longest, since the boxes of more than that hardly meet in one place. Looks at every cell of every
/// solid.
std::uint32_t contact_iterations(const PreparedSolids& solids, const Parameters& parameters);

}  // namespace palpa::touch
