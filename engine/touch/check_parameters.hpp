// What may be asked of a scene.
#pragma once

#include "touch/contacts/prepared_solids.hpp"
#include "touch/types.hpp"

namespace palpa::touch {

/// Throws bad_usage unless delta and finger gap are finite and positive, the finger width finite and not negative, 1 <=
/// foci <= max_foci, the solids are prepared for these parameters, and the gap is not so small against the largest
/// solid (1/18,000 of half its size) that single precision could not place a contact in a cell.
void check_parameters(const Parameters& parameters, const PreparedSolids& solids);

}  // namespace palpa::touch
