// The solid that a convex part belongs to.
#pragma once

#include <cstdint>
#include <string>

namespace palpa::geometry {

/// Marks a mesh as one convex part of a solid. palpa decompose writes it into the node's `extras`.
struct PartOf {
  std::string solid;        ///< the solid's name
  std::uint32_t group = 0;  ///< distinguishes solids of the same name
  double seam_m = 0;        ///< see Parts::seam_m
};

}  // namespace palpa::geometry
