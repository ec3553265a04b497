// Contacts: the skin points in the shell of a solid, Eq. (1) of the paper, in plain C++.
#pragma once

#include <cstdint>
#include <span>

#include "sensing/skin_twin.hpp"
#include "shaders/touch/contacts/reach.h"
#include "touch/contacts/prepared_solids.hpp"
#include "touch/types.hpp"

namespace palpa::touch {

/// Fingers of the frame before around which contacts reach beyond the shell's edges.
struct FingerReach {
  const shader::ReachTable* table = nullptr;  ///< null, or empty: no contact does
  std::uint32_t elapsed_us = 0;               ///< from the frame before to this one
};

/// C++ twin of ContactsPass, in the same single-precision arithmetic, so it finds the same contacts with the same
/// depths. Fills `out.contacts` and, if requested, `out.deep`. A contact lies strictly inside a solid and nearer to its
/// surface than the solid's delta; it belongs to the first solid for which this holds. A point that is not a contact is
/// a deep point of the first solid that contains it. Points with a coordinate that is not finite are neither. The
/// result agrees with double precision except within 1 micrometre of a boundary (solids up to 3 m). Around a known
/// finger that is about to end, points up to 0.5 mm beyond the edges of its solid's shell are contacts as well, marked
/// `beyond`.
void find_contacts(std::span<const sensing::SkinPoint> points, const PreparedSolids& solids,
                   const Parameters& parameters, const FingerReach& reach, Touch& out);

}  // namespace palpa::touch
