// A finger of the paper's size (section IV-A: 5 cm from the tip, 4322 faces).
#pragma once

#include "geometry/mesh/mesh.hpp"

namespace palpa::assets {

/// A closed, smooth finger with its tip at the origin, pointing down, its body along +y up to y = 50 mm. A tip of 8 mm
/// radius blends into a slowly widening shaft, up to 18.5 mm wide along x and a tenth flatter along z, closed by a
/// rounded end. It has exactly 2163 vertices and 4322 triangles. Neighbouring vertices are 0.5 mm apart at the tip,
/// where even the pyramid's point must touch some twenty of them, and 1.4 mm apart on the shaft.
geometry::Mesh make_finger();

}  // namespace palpa::assets
