// A rigid body in sound: computes the sound at its surface from an incident wave, and the sound that it scatters.
//
// Made once per body and wave number; each further wave only costs right-hand sides. The wave number is that of
// lossless air: absorption and directivity are part of the incident wave and its slope.
#pragma once

#include <atomic>
#include <complex>
#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include "acoustics/boundary/surface_operator.hpp"
#include "acoustics/boundary/surface_sound.hpp"
#include "acoustics/elements/patches.hpp"
#include "acoustics/field/incident.hpp"
#include "geometry/mesh/mesh.hpp"

namespace palpa::acoustics {

class RigidBody {
 public:
  /// `mesh` is welded, closed, oriented outwards (body_mesh.hpp checks that), `wave_number` in 1/m. Throws GivenUp
  /// (base/system/parallel.hpp) soon after `give_up` becomes true.
  RigidBody(geometry::Mesh mesh, double wave_number, const std::atomic<bool>* give_up = nullptr);

  const geometry::Mesh& mesh() const { return patches_.mesh; }
  const Patches& patches() const { return patches_; }
  double wave_number() const { return wave_number_; }

  /// The points at which the incident wave and its slope along the outward normals are needed: three samples per face.
  std::span<const Vec3> points() const { return points_; }
  std::span<const Vec3> normals() const { return normals_; }
  /// The area of the curved surface that each of these points represents, m2.
  std::span<const double> areas() const { return areas_; }
  /// The normals at the vertices: means of the normals around them.
  std::span<const Vec3> vertex_normals() const { return vertex_normals_; }

  /// The unknowns of every wave in `incident` at points(), one wave after the other: one complex number per vertex,
  /// only meaningful as input of the functions below. Throws failure() if they are not finite, or if the iterations of
  /// a large body do not converge; GivenUp soon after `give_up` becomes true.
  std::vector<std::complex<float>> solve(const Waves& incident, const std::atomic<bool>* give_up = nullptr) const;

  /// Replaces right-hand sides by their unknowns, one column after the other, with one number per vertex each: the
  /// integrals of the incident p + slope_part() dp/dn times the vertex' hat function. Throws like solve().
  void respond(std::span<std::complex<float>> right_sides, const std::atomic<bool>* give_up = nullptr) const;

  /// How the unknowns are found, and the worst report of all solutions so far, including backward ones.
  struct Effort {
    bool iterates = false;  ///< by iterations, as for large bodies (surface_operator.hpp)
    SolveReport worst;
  };
  Effort effort() const;

  /// For one wave's unknowns: total pressure and its surface gradient at the faces' centroids, total pressure at the
  /// vertices.
  std::vector<FaceSound> at_faces(std::span<const std::complex<float>> unknowns) const;
  std::vector<std::complex<double>> at_vertices(std::span<const std::complex<float>> unknowns) const;
  /// At the faces' centroids and, as `samples`, at points().
  SkinSound on_skin(std::span<const std::complex<float>> unknowns) const;

  /// The same at (u, v) on the patch of a face.
  FaceSound at_skin(std::span<const std::complex<float>> unknowns, std::uint32_t face, double u, double v) const;

  /// The scattered pressure (total minus incident) at points in the air, at any distance from the surface. On the body
  /// and inside it (body_places.hpp), the result is meaningless.
  std::vector<std::complex<double>> scattered(std::span<const std::complex<float>> unknowns,
                                              std::span<const Vec3> points) const;

  /// The pressure at a place as a row: one number per vertex; its dot product with the unknowns is the pressure.
  using Row = std::vector<std::complex<float>>;
  /// The total pressure at the place of at_skin; the scattered pressure at a point in the air.
  Row row_on_skin(std::uint32_t face, double u, double v) const;
  Row row_in_air(const Vec3& at) const;

  /// Weights of what arrives at points(): of the incident pressure there, plus slope_part() times its slope along
  /// normals(). The weighted sum is the pressure at each place: entry [place * points + point]. With Incident::received
  /// they give the effect of each transducer there.
  std::vector<std::complex<double>> sources_of(std::span<const Row> rows) const;
  /// i/k.
  std::complex<double> slope_part() const { return {0, 1 / wave_number_}; }

 private:
  struct SharedEffort {
    std::mutex mutex;
    SolveReport worst;
  };
  void find_unknowns(Way way, std::span<std::complex<float>> columns, const std::atomic<bool>* give_up) const;

  Patches patches_;
  double wave_number_;
  std::vector<Vec3> points_, normals_;
  std::vector<double> areas_;  // by point: the area that it represents
  std::vector<Vec3> vertex_normals_;
  SurfaceFit fit_;
  std::unique_ptr<SurfaceOperator> operator_;
  std::unique_ptr<SharedEffort> effort_ = std::make_unique<SharedEffort>();
};

}  // namespace palpa::acoustics
