// The force of sound on a body, from the momentum that the sound carries through the air around it. It needs the
// pressures on the surface, but not their slopes, so it is a check of the force by radiation pressure (radiation.hpp).
//
//   F = -1 / (2 rho c^2) integral over all directions s of s (|f|^2 - (4 pi / k) Im(conj(g) f))
//   g_lm = q_lm (-i)^l / (4 pi (j_l(kR) + i j_l'(kR))),  q = p + (i/k) dp/dr of the incident wave at the radius R
//
// Peak phasors; f e^{ikr} / r is the scattered wave far away, g the incident one as a sum of plane waves. The air does
// not absorb. docs/notes/radiation-force.md has the derivation.
#pragma once

#include <complex>
#include <optional>
#include <span>
#include <vector>

#include "acoustics/air.hpp"
#include "acoustics/bodies/rigid_body.hpp"
#include "acoustics/bodies/sphere_grid.hpp"
#include "acoustics/boundary/far_sums.hpp"
#include "acoustics/field/incident.hpp"
#include "array/layouts/layout.hpp"

namespace palpa::acoustics {

class FarForce {
 public:
  /// `body` must outlive it. nullopt if one of the sources is within 1.05 times the radius of the sphere around the
  /// body: the force from afar is then not defined. Also nullopt if the sphere needs more than 5000 points and more
  /// than half as many as the body, as around a long wire or a mesh that is far too coarse: the computation would then
  /// be too slow.
  static std::optional<FarForce> of(const RigidBody& body, std::span<const Vec3> sources);

  /// Where the incident wave is needed, with its slope along these outward normals.
  std::span<const Vec3> points() const { return points_; }
  std::span<const Vec3> normals() const { return sphere_.directions(); }

  /// The force of each wave in `incident` at points(), whose unknowns on the body follow one after the other, in N.
  std::vector<Vec3> forces(const Waves& incident, std::span<const std::complex<float>> unknowns, const Air& air) const;

 private:
  FarForce(const RigidBody& body, const Vec3& centre, double radius, double sources_m);

  const RigidBody* body_;
  double radius_;
  SphereGrid sphere_;  // of the points
  SphereGrid far_;     // of the directions of f and g
  std::vector<Vec3> points_;
  FarSamples samples_;
};

/// The strengths of an array's drive for lossless air, reduced so that each transducer's sound is as loud at `place` as
/// it is in `air`.
Strengths without_absorption(std::span<const std::complex<double>> strengths, const array::Layout& layout,
                             const Air& air, const Vec3& place);
/// The vertex at which the unknowns of one wave are largest.
Vec3 loudest_vertex(const RigidBody& body, std::span<const std::complex<float>> unknowns);

}  // namespace palpa::acoustics
