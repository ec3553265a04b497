// How far the skin is from the solids that are shown, to say why nothing touches.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "geometry/mesh/nearest.hpp"
#include "sensing/skin_point.hpp"
#include "viewer/picture/picture.hpp"

namespace palpa::viewer {

class NearestSeen {
 public:
  /// `solids` are at rest and must outlive this.
  explicit NearestSeen(std::span<const SurfaceMark> solids);

  /// "the nearest skin is 31.0 mm away from the surface of cube", or that there is no skin. If there are more
  /// than 4096 points, only every n-th counts. `poses` move the solids, by their index; those without a pose are at
  /// rest.
  std::string tell(std::span<const sensing::SkinPoint> points, std::span<const Transform> poses) const;

 private:
  std::span<const SurfaceMark> solids_;
  std::vector<geometry::NearestTriangle> trees_;
};

}  // namespace palpa::viewer
