// The check of the parameters for a scene.
#pragma once

#include "touch/contacts/prepared_solids.hpp"
#include "touch/types.hpp"

namespace palpa::touch {

/// Throws bad_usage unless all of these hold: delta and finger gap are finite and positive, the finger width is finite
/// and not negative, 1 <= foci <= max_foci, and the solids are prepared for these parameters. Also throws bad_usage if
/// the gap is so small compared with the largest solid (1/18,000 of half its size) that single precision could not
/// place a contact in a cell.
void check_parameters(const FingerOptions& parameters, const PreparedSolids& solids);

}  // namespace palpa::touch
