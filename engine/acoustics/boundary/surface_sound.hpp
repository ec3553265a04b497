// Pressures and their slopes on the surface, more accurate than those of linear elements.
//
// Fits a polynomial of fifth degree for each face by least squares: its averages over the hat functions
// (hat_averages.hpp) of the vertices of the face, and of two rings of faces around it, are those of the solution. A
// vertex counts less if it is farther away (a Gauss curve, 1/e at one side's length) or if the surface turns away there
// (the cosine's square). Coordinates are those in the plane that touches the patch at its centroid. A sharp edge
// (patches.hpp) ends the rings. Beside it, the polynomial has the fourth degree and fits the linear elements. The
// degree is lower if there are too few vertices. docs/notes/boundary-elements.md has the reasons.
#pragma once

#include <array>
#include <complex>
#include <cstdint>
#include <span>
#include <vector>

#include "acoustics/elements/face_fit.hpp"
#include "acoustics/elements/hat_averages.hpp"
#include "acoustics/elements/patches.hpp"

namespace palpa::acoustics {

using ComplexVec3 = std::array<std::complex<double>, 3>;

struct FaceSound {
  std::complex<double> pressure;  ///< Pa, peak
  ComplexVec3 gradient;           ///< along the surface, Pa/m
};

/// The sound on a surface: at the centroids of its patches, one entry per face, and at the three samples of
/// three_point_rule() of each.
struct SkinSound {
  std::vector<FaceSound> faces, samples;
};

class SurfaceFit {
 public:
  explicit SurfaceFit(const Patches& body);

  /// `solution`: the unknowns at the vertices. `body` is the one that the fit was made for.
  SkinSound on(const Patches& body, std::span<const std::complex<float>> solution) const;
  /// Only SkinSound::faces.
  std::vector<FaceSound> at_faces(std::span<const std::complex<float>> solution) const;
  /// One entry per vertex: the mean of the polynomials of the faces around it.
  std::vector<std::complex<double>> at_vertices(std::span<const std::complex<float>> solution) const;

  /// At a point of a face's patch with this unit normal.
  FaceSound at(std::size_t face, const Vec3& point, const Vec3& normal,
               std::span<const std::complex<float>> solution) const;

  /// Adds to `row`, one entry per vertex, the factors of the unknowns that give the pressure at a point of the face's
  /// patch.
  void add_pressure_row(std::uint32_t face, const Vec3& at, std::span<std::complex<float>> row) const;

 private:
  using Complex = std::complex<double>;
  static FaceSound value(const FaceFit& fit, std::span<const Complex> polynomial, const Vec3& point,
                         const Vec3& normal);
  /// `averages` are those of the solution; if empty, the few that are needed are computed.
  void polynomial(const FaceFit& fit, std::span<const std::complex<float>> solution, std::span<const Complex> averages,
                  std::span<Complex> coefficients) const;

  HatAverages averages_;
  std::vector<FaceFit> fits_;
  std::vector<std::array<std::uint32_t, 3>> corners_;
  std::vector<Vec3> positions_;
};

}  // namespace palpa::acoustics
