// Contacts: the skin points in the shell of a solid, Eq. (1) of the paper, in plain C++.
#pragma once

#include <span>

#include "sensing/skin_twin.hpp"
#include "touch/contacts/prepared_solids.hpp"
#include "touch/types.hpp"

namespace palpa::touch {

/// C++ twin of ContactsPass, in the same single-precision arithmetic, so the same contacts with the same depths: fills
/// `out.contacts` and, where asked for, `out.deep`. A contact lies strictly inside a solid and nearer than its delta to
/// its surface; it belongs to the first solid for which that is so. A point that is no contact is a deep point of the
/// first solid that it lies inside of. Points with a coordinate that is not finite are neither. Of convex solids the
/// twin asks every plane; the pass asks those of a cell. Agrees with double precision except within 1 micrometre of a
/// boundary (solids up to 3 m).
void find_contacts(std::span<const sensing::SkinPoint> points, const PreparedSolids& solids,
                   const Parameters& parameters, Touch& out);

}  // namespace palpa::touch
