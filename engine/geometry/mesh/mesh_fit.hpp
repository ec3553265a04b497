// Finds the pose of a mesh from points measured on it: the rigid transform that moves the points onto the mesh's faces.
// Needs an initial guess that is within a few millimetres and degrees.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "geometry/mesh/mesh.hpp"
#include "geometry/mesh/nearest.hpp"

namespace palpa::geometry {

struct MeasuredPoint {
  Vec3 position;  ///< metres
  /// The expected error, directed away from the measuring device: a depth camera errs along its rays. Only the
  /// proportions among a fit's points matter.
  Vec3 error;
};

struct FitOptions {
  double gate_m = 3e-3;  ///< points farther from the mesh do not belong to it
  /// Points nearer than this to an edge at which the mesh bends are left out: they may belong to either side, and
  /// devices that measure with a window round edges off.
  double crease_m = 2.5e-3;
  double lever_m = 0.05;  ///< a rotation by an angle counts like a shift by that angle times this
  double alike = 7;       ///< roughly this many points share one error
  int steps = 12;         ///< at most
  /// Of Tukey's biweight, in standard deviations: 95 % as efficient as least squares if there are no outliers.
  double tukey = 4.685;
};

struct MeshFitted {
  Transform T_mesh_points{1.0};
  std::uint32_t points = 0;     ///< number of points that were neither left out nor outliers
  double rms_m = 0, p95_m = 0;  ///< of their distances from the faces
  /// How firmly the points constrain the pose. A shift by 1 mm (or an equivalent rotation, see lever_m) in the least
  /// constrained direction changes the points' distances from the faces by this many millimetres, rms. 0: the mesh can
  /// slide.
  double hold = 0;
  double deviation_m = 0, deviation_rad = 0;  ///< largest standard deviations, from the points' scatter
};

/// The measured size divided by the mesh's size.
struct ScaleFitted {
  double scale = 1;
  /// Its standard deviation from the points' scatter; infinite if the points do not determine the scale: three planes
  /// look the same at every scale.
  double deviation = std::numeric_limits<double>::infinity();
  Transform T_mesh_points{1.0};  ///< with the scale removed
};

class MeshFit {
 public:
  /// `mesh` is welded, closed, oriented outwards, and has at least one edge at which it bends.
  explicit MeshFit(const Mesh& mesh);
  MeshFit(const MeshFit&) = delete;
  MeshFit& operator=(const MeshFit&) = delete;

  /// Iterated least squares of the distances from the tangent planes of the nearest points (point to plane). Each point
  /// is weighted by Tukey's biweight of its distance over its error. Faces that look away from the measuring device get
  /// no points. The same points give the same bytes. Without points, or if the points constrain nothing, the result has
  /// 0 points and the guess.
  MeshFitted fit(std::span<const MeasuredPoint> points, const Transform& T_guess, const FitOptions& options) const;

  /// The same with scale as a seventh unknown, for measurements that may be a few percent larger or smaller than the
  /// mesh; T_guess is within a few millimetres. A target of another size and a scale error of the measurement look
  /// alike.
  ScaleFitted fit_scale(std::span<const MeasuredPoint> points, const Transform& T_guess,
                        const FitOptions& options) const;

  /// Metres from the mesh, or `most` if that is smaller.
  double distance(const Vec3& point, double most) const { return nearest_.distance(point, most); }

 private:
  struct Hit;
  template <std::size_t n>
  struct Sums;
  template <std::size_t n>
  struct Solution;
  template <std::size_t n>
  static Sums<n> sum_up(std::span<const Hit> hits, const Vec3& centre, double lever_m);
  template <std::size_t n>
  bool solve(std::span<const MeasuredPoint> points, const FitOptions& options, Solution<n>& solution) const;
  void find_hits(std::span<const MeasuredPoint> points, const Transform& T_mesh_points, const FitOptions& options,
                 std::vector<Hit>& hits) const;

  Mesh mesh_;
  std::vector<Vec3> normals_;  ///< of the triangles
  NearestTriangle nearest_;
  Mesh creases_;  ///< triangles with zero area
  NearestTriangle nearest_crease_;
};

}  // namespace palpa::geometry
