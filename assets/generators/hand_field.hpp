// The hand's skin as a level set: bones under soft flesh.
#pragma once

#include "assets/generators/hand_bones.hpp"

namespace palpa::assets {

/// Roughly the distance to the skin, negative inside. It is smooth except for faint creases deep inside and far
/// outside.
class HandField {
 public:
  explicit HandField(HandBones bones) : bones_(std::move(bones)) {}
  double operator()(const Vec3& point) const;
  /// A box that contains the skin with a wide margin.
  Box bounds() const;

 private:
  HandBones bones_;
};

}  // namespace palpa::assets
