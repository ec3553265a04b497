// Which solid a convex part belongs to.
#pragma once

#include <cstdint>
#include <string>

namespace palpa::geometry {

/// What makes a mesh one convex part of a solid: palpa decompose writes it into the node's `extras`.
struct PartOf {
  std::string solid;        ///< the solid's name
  std::uint32_t group = 0;  ///< tells solids of one name apart
  double seam_m = 0;        ///< see Parts::seam_m
};

}  // namespace palpa::geometry
