// Finds where a finger stands: the pose of its mesh from the skin that depth cameras see near its contacts.
//
// Each skin point is compared with the plane of the nearest face (point to plane, iterated least squares). Points are
// weighted by Tukey's biweight, so that the skin of other fingers has little effect. The mesh's end is no skin, and
// points beyond it belong to the hand. Directions that the skin does not determine, such as a rotation of a round
// finger about its own axis, stay as they were.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/math.hpp"
#include "geometry/mesh/mesh.hpp"
#include "geometry/mesh/nearest.hpp"

namespace palpa::session {

struct FittedPose {
  Transform T_world_finger{1.0};
  std::uint32_t points = 0;  ///< of the skin, that fit
  double rms_m = 0;          ///< of their distances from the mesh
};

Vec3 mean_of(std::span<const Vec3> points);

class FingerFit {
 public:
  /// How far from its contacts the skin of a finger is used.
  static constexpr double reach_m = 25e-3;

  /// `finger` has its tip at the origin and its body along +y, and must outlive it.
  explicit FingerFit(const geometry::Mesh& finger);

  /// `skin` and `contacts`, their centroid, are in the world, in metres. Begins at `before`, the finger's last pose, if
  /// it still fits there. Otherwise tries two directions: from the contacts to the middle of the skin, and the longest
  /// one of the skin. nullopt if the mesh does not fit: fewer than `fewest` points within `near_m`, or fewer than half
  /// of the skin within reach.
  std::optional<FittedPose> find(std::span<const Vec3> skin, const Vec3& contacts,
                                 const std::optional<Transform>& before) const;

 private:
  static constexpr std::uint32_t fewest = 30, most = 300;
  static constexpr double near_m = 1.5e-3;

  FittedPose fit(std::span<const Vec3> skin, Transform T_world_finger, int steps) const;
  void measure(std::span<const Vec3> skin, FittedPose& pose) const;

  geometry::NearestTriangle nearest_;
  std::vector<Vec3> normals_;  ///< of the faces
  double end_m_;               ///< skin beyond this y is no part of the finger
};

}  // namespace palpa::session
