// A rigid body in the sound: what reaches its surface, what that becomes there, and what it sends into the air.
//
// Made once per body and wave number; every further wave costs right-hand sides only. The wave number is that of the
// lossless air: absorption, and directivity, belong to the incident wave and its slope.
#pragma once

#include <atomic>
#include <complex>
#include <memory>
#include <span>
#include <vector>

#include "acoustics/boundary/patches.hpp"
#include "acoustics/boundary/surface_operator.hpp"
#include "acoustics/boundary/surface_sound.hpp"
#include "acoustics/field/incident.hpp"
#include "geometry/mesh/mesh.hpp"

namespace palpa::acoustics {

class RigidBody {
 public:
  /// `mesh` is welded, closed, oriented outwards (body_mesh.hpp checks that), `wave_number` in 1/m. Throws GivenUp
  /// (base/parallel.hpp) soon after `give_up` became true.
  RigidBody(geometry::Mesh mesh, double wave_number, const std::atomic<bool>* give_up = nullptr);

  const geometry::Mesh& mesh() const { return patches_.mesh; }
  const Patches& patches() const { return patches_; }
  double wave_number() const { return wave_number_; }

  /// Where the incident wave is asked for, with its slope along the outward normals: three samples per face.
  std::span<const Vec3> points() const { return points_; }
  std::span<const Vec3> normals() const { return normals_; }

  /// The unknowns of every wave that `incident` has at points(), one wave after the other: one complex number per
  /// vertex, of use to what follows only. Throws failure() where they are no numbers.
  std::vector<std::complex<float>> solve(const Waves& incident) const;

  /// Of one wave's unknowns: total pressure and its surface gradient at the faces' centroids, total pressure at the
  /// vertices.
  std::vector<FaceSound> at_faces(std::span<const std::complex<float>> unknowns) const;
  std::vector<std::complex<double>> at_vertices(std::span<const std::complex<float>> unknowns) const;

  /// The same on the patch of a face, at its (u, v).
  FaceSound at_skin(std::span<const std::complex<float>> unknowns, std::uint32_t face, double u, double v) const;

  /// The scattered pressure, total less incident, at points in the air, whatever their distance from the surface. On
  /// the body and inside of it (body_places.hpp) it is of no use.
  std::vector<std::complex<double>> scattered(std::span<const std::complex<float>> unknowns,
                                              std::span<const Vec3> points) const;

  /// What is heard at a place as a row: one number per vertex, by which the unknowns are multiplied and summed up.
  using Row = std::vector<std::complex<float>>;
  /// The total pressure at at_skin's place; the scattered pressure at a point in the air.
  Row row_on_skin(std::uint32_t face, double u, double v) const;
  Row row_in_air(const Vec3& at) const;

  /// Sources at points(), with those along normals(), that what an incident wave makes heard there is the sum over:
  /// entry [place * points + point]. With Incident::received they give what each transducer does there.
  struct Sources {
    std::vector<std::complex<double>> strengths, slopes;
  };
  Sources sources_of(std::span<const Row> rows) const;
  /// Of the total pressure at the faces' centroids.
  Sources sources_at_faces(std::span<const std::uint32_t> faces) const;

 private:
  Patches patches_;
  double wave_number_;
  std::vector<Vec3> points_, normals_;
  std::vector<double> areas_;  // by point: area that it stands for
  SurfaceFit fit_;
  std::unique_ptr<SurfaceOperator> operator_;
};

}  // namespace palpa::acoustics
