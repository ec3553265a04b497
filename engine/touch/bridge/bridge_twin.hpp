// Hidden skin: patches of contacts on two sides of one fingertip, its underside seen by no camera, are one finger.
//
// Euclidean clusters of one solid are joined where three things hold (docs/touch.md tells why):
// - together they are no wider than a finger, along the line between their means;
// - between the contacts that face each other the way enters the skin at either end, as it does between any two places
//   of a convex body: the skin's outward normals are those of the depth pictures;
// - no camera saw the space between them empty: that is, something clearly farther than it, in its direction.
// The surest pair is joined first; two patches that cannot be one finger are never joined through a third.
#pragma once

#include "touch/bridge/sight.hpp"
#include "touch/types.hpp"

namespace palpa::touch {

/// C++ twin of BridgePass: joins fingers of `out`, whose contacts' points are pixels of the pictures. The arithmetic is
/// the same; where a device divides and takes roots exactly, so are the decisions.
void bridge_fingers(const Sight& sight, const Parameters& parameters, Touch& out);

}  // namespace palpa::touch
