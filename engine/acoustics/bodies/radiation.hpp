// The steady second-order pressure of sound on rigid skin, averaged over the tone's period (Langevin; Eckart 1948,
// Awatani 1955). It follows from the total field at the surface, where nothing moves along the normal, as peak phasors:
//
//   langevin  P = (|p|^2 - |grad_S p|^2 / k^2) / (4 rho c^2)
//   squared   P = |p|^2 / (4 rho c^2)
//
// The second term of the first formula is the kinetic energy of the air that slides along the skin. At grazing
// incidence it may exceed the first term, so that the skin is pulled; this is correct and is not clamped. `squared`
// omits this term, as pictures of |p|^2 do.
#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "acoustics/air.hpp"
#include "acoustics/bodies/rigid_body.hpp"
#include "base/math.hpp"
#include "geometry/mesh/mesh.hpp"

namespace palpa::acoustics {

Vec3 face_centroid(const geometry::Mesh& mesh, std::size_t face);
double face_area(const geometry::Mesh& mesh, std::size_t face);

/// The radiation pressure of one sound, Pa.
struct Radiation {
  double langevin, squared;
};
Radiation radiation_of(const FaceSound& sound, const Air& air);

/// Force in N and torque in Nm about a point.
struct Load {
  Vec3 force{0}, torque{0};
};
/// The load about `point` of a load about the origin.
Load about(const Vec3& point, const Load& load);

struct SkinPressure {
  std::vector<double> langevin, squared;  ///< per face, at its centroid, Pa
  double loudest_pa = 0;                  ///< largest |p| of any sound at any face
  /// Both pressures push along the inward normals of the whole curved surface. About the origin.
  Load langevin_load, squared_load;
  double langevin_push_n = 0;  ///< the integral of |langevin| over the surface
};

/// Adds the pressure of one sound, given by the unknowns of a body, times `weight`. Averages over a schedule are sums
/// of these. Loads are sums over the body's points().
void add_pressure(const RigidBody& body, std::span<const std::complex<float>> unknowns, const Air& air, double weight,
                  SkinPressure& pressure);

/// The mean of the faces around each vertex, weighted by area.
std::vector<double> at_vertices(const geometry::Mesh& mesh, std::span<const double> faces);

/// Summary of a pressure on skin.
struct Spot {
  double peak_pa = 0;        ///< largest of any face
  Vec3 peak_at{0};           ///< that face's centroid
  double half_area_m2 = 0;   ///< total area of the faces with more than half the peak
  double half_radius_m = 0;  ///< of a disc of that area
  double elongation = 1;     ///< elongation_of() these faces' centroids and areas
};
/// sqrt(l1 / l2) of the covariance of points that represent areas; 1 for fewer than three.
double elongation_of(std::span<const Vec3> points, std::span<const double> areas);
Spot spot_of(const geometry::Mesh& mesh, std::span<const double> pressure);

}  // namespace palpa::acoustics
