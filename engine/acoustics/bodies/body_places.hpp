// Where points are beside a body: in the air around it, on its skin, or inside, where there is no sound.
//
// Between a body's curved patches (patches.hpp) and its mesh's flat faces lies a thin gap that is both or neither. What
// is in it, or within a thousandth of a side from it, is on the skin: pressure does not change along the normal there,
// over a width that is a small part of a side's square.
#pragma once

#include <cstdint>

#include "acoustics/bodies/body_mesh.hpp"
#include "acoustics/boundary/patches.hpp"
#include "base/math.hpp"
#include "geometry/mesh/nearest.hpp"

namespace palpa::acoustics {

struct BodyPlace {
  enum class Where { air, skin, inside };
  Where where = Where::air;
  std::uint32_t face = 0;  ///< the nearest one, and the place in its patch that is next to the point
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
