// Where a mesh is, from points that were measured on it: the rigid transform that brings them onto its faces, from a
// guess that is a few millimetres and degrees off.
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
  /// By how much it errs, away from whoever measures: a depth camera errs along its rays. Only proportions among a
  /// fit's points count.
  Vec3 error;
};

struct FitOptions {
  double gate_m = 3e-3;  ///< points farther from the mesh are not on it
  /// Points nearer than this to an edge at which the mesh bends are left out: they may belong to either side, and what
  /// measures with a window rounds edges off.
  double crease_m = 2.5e-3;
  double lever_m = 0.05;  ///< a turn by an angle counts like a shift by that angle times this
  double alike = 7;       ///< about so many points err together
  int steps = 12;         ///< at most
  /// Of Tukey's biweight, in standard deviations: as good as least squares to 95 % where there is no outlier.
  double tukey = 4.685;
};

struct MeshFitted {
  Transform T_mesh_points{1.0};
  std::uint32_t points = 0;     ///< that were neither left out nor outliers
  double rms_m = 0, p95_m = 0;  ///< of their distances from the faces
  /// How firmly the points hold the mesh: a shift by 1 mm (or a turn that is as much, see lever_m) in the direction in
  /// which they hold it least changes their distances from its faces by so many millimetres, rms. 0: it may slide.
  double hold = 0;
  double deviation_m = 0, deviation_rad = 0;  ///< standard deviations where they are largest, from the points' scatter
};

/// How much larger than the mesh what was measured is.
struct ScaleFitted {
  double scale = 1;
  /// Its standard deviation from the points' scatter; infinite where they say nothing of it: three planes are the same
  /// at every scale.
  double deviation = std::numeric_limits<double>::infinity();
  Transform T_mesh_points{1.0};  ///< with the scale taken out
};

class MeshFit {
 public:
  /// `mesh` is welded, closed, oriented outwards, and bends somewhere.
  explicit MeshFit(const Mesh& mesh);
  MeshFit(const MeshFit&) = delete;
  MeshFit& operator=(const MeshFit&) = delete;

  /// Iterated least squares of the distances from the tangent planes of the nearest points (point to plane), each point
  /// by Tukey's biweight of its distance over its error. Faces that look away from whoever measures have no points.
  /// The same points give the same bytes. No points or nothing that holds: 0 of them, and the guess.
  MeshFitted fit(std::span<const MeasuredPoint> points, const Transform& T_guess, const FitOptions& options) const;

  /// The same with a seventh unknown: T_guess is within a few millimetres where what was measured may be some percent
  /// larger or smaller than the mesh. A target of another scale and a measure of another scale look alike.
  ScaleFitted fit_scale(std::span<const MeasuredPoint> points, const Transform& T_guess,
                        const FitOptions& options) const;

  /// Metres from the mesh, or `most` where that is less.
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
  Mesh creases_;  ///< triangles without area
  NearestTriangle nearest_crease_;
};

}  // namespace palpa::geometry
