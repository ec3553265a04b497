// Locates points relative to a body: in the air around it, on its skin, or inside, where there is no sound.
//
// Between a body's curved patches (patches.hpp) and its mesh's flat faces there is a thin gap. It lies inside the body
// by one of these two surfaces and outside by the other. Points in the gap, or within a thousandth of a side of it,
// count as on the skin. The gap is narrow, because its width grows with the square of a side. Over such a distance, the
// pressure does not change along the normal.
#pragma once

#include <cstdint>

#include "acoustics/bodies/body_mesh.hpp"
#include "acoustics/elements/patches.hpp"
#include "base/math.hpp"
#include "geometry/mesh/nearest.hpp"

namespace palpa::acoustics {

struct BodyPlace {
  enum class Where { air, skin, inside };
  Where where = Where::air;
  std::uint32_t face = 0;  ///< the nearest one, and the (u, v) in its patch nearest to the point
  double u = 0, v = 0;
  double distance_m = 0;  ///< from that face
};

class BodyPlaces {
 public:
  /// `body` must outlive it.
  explicit BodyPlaces(const Patches& body);
  BodyPlace of(const Vec3& point) const;

 private:
  const Patches& body_;
  geometry::NearestTriangle nearest_;
  Inside inside_;
};

}  // namespace palpa::acoustics
