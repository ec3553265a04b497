// Contacts: the skin points in the shell of a solid, Eq. (1) of the paper, in plain C++.
#pragma once

#include <span>

#include "sensing/skin_point.hpp"
#include "touch/contacts/finger_reach.hpp"
#include "touch/contacts/prepared_solids.hpp"
#include "touch/types.hpp"

namespace palpa::touch {

/// C++ twin of ContactsPass, in the same single-precision arithmetic, so it finds the same contacts with the same
/// depths. Fills `out.contacts` and, if requested, `out.deep`. A contact lies strictly inside a solid and nearer to its
/// surface than the solid's delta; it belongs to the first solid for which this holds. A point that is not a contact is
/// a deep point of the first solid that contains it. Points with a coordinate that is not finite are neither. The
/// result agrees with double precision except within 1 micrometre of a boundary (solids up to 3 m). Around a known
/// finger that is about to end, points up to 0.5 mm beyond the edges of its solid's shell are contacts as well, marked
/// `beyond`.
void find_contacts(std::span<const sensing::SkinPoint> points, const PreparedSolids& solids,
                   const FingerOptions& parameters, const FingerReach& reach, Touch& out);

}  // namespace palpa::touch
