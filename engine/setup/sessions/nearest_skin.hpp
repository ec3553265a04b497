// The distance from the skin to the nearest solid, to report when nothing is touched.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>

#include "geometry/solid.hpp"
#include "setup/sessions/touch_input.hpp"

namespace palpa::setup {

/// The skin point that is nearest to the surface of a solid.
struct NearestSkin {
  double distance_m;  ///< to that surface
  std::size_t solid;  ///< index into the solids
  bool inside;        ///< below the surface, so it is deeper than the thickness of the shell
};

/// Empty without skin. Looks at every skin point (with depth images, every valid pixel), but only at those triangles
/// that may be the nearest.
std::optional<NearestSkin> nearest_skin(std::span<const geometry::Solid> solids, const TouchInput& input);
/// "0.5 mm away from the surface of cube".
std::string place_of(const NearestSkin& nearest, const std::string& solid);
std::string place_of(const NearestSkin& nearest, std::span<const geometry::Solid> solids);

}  // namespace palpa::setup
