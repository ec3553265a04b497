// Hidden skin: if no camera sees the underside of a fingertip, the patches of contacts on its two sides are joined to
// one finger.
//
// Euclidean clusters of one solid are joined under three conditions (docs/touch.md has all rules):
// - Together, they are no wider than a finger from one side to the other.
// - Between their means, or between the contacts that face each other, the line enters the skin at both ends, as it
//   does between any two places of a convex body. The skin's outward normals come from the depth pictures.
// - No camera saw that the space between them is empty, that is, no camera saw something clearly farther away in that
//   direction.
// They are also joined if cameras see the skin between them: the rings of a finger through a plate, or the halves of
// the ring of a finger that lies deep. The most certain pair is joined first. Two patches that cannot be one finger are
// never joined through a third one.
#pragma once

#include "touch/fingers/known_labels.hpp"
#include "touch/fingers/sight.hpp"
#include "touch/types.hpp"

namespace palpa::touch {

/// Joins fingers of `out`, to which `skins` belong. The points of their contacts are pixels of the pictures.
void bridge_fingers(const Sight& sight, const FingerOptions& parameters, const Known& known, Touch& out,
                    FingerSkins& skins);

}  // namespace palpa::touch
