// Pressures and their slopes on the surface, more accurate than those of linear elements.
//
// Galerkin's solution in linear elements is far more accurate on average over a few faces than at any point: a vertex
// overshoots, a centroid falls short. Therefore a quadratic is fitted to the linear elements over each face and its
// neighbours, by least squares over their area, up to sharp edges (patches.hpp). Pressure and surface gradient are the
// quadratic's at the face's centroid.
#pragma once

#include <array>
#include <complex>
#include <cstdint>
#include <span>
#include <vector>

#include "acoustics/boundary/patches.hpp"

namespace palpa::acoustics {

using ComplexVec3 = std::array<std::complex<double>, 3>;

struct FaceSound {
  std::complex<double> pressure;  ///< Pa, peak
  ComplexVec3 gradient;           ///< along the surface, Pa/m
};

class SurfaceFit {
 public:
  explicit SurfaceFit(const Patches& body);

  /// `solution`: the unknowns at the vertices. One entry per face.
  std::vector<FaceSound> at_faces(std::span<const std::complex<float>> solution) const;
  /// One entry per vertex: the mean of the quadratics of the faces around it.
  std::vector<std::complex<double>> at_vertices(std::span<const std::complex<float>> solution) const;

  /// At a point of a face's patch. The gradient lies in the plane that touches the patch at its centroid.
  FaceSound at(std::size_t face, const Vec3& point, std::span<const std::complex<float>> solution) const;

  /// Adds to `row`, one entry per vertex, the factors of the unknowns that give the face's pressure at its centroid, or
  /// at a point of its patch.
  void add_pressure_row(std::uint32_t face, std::span<std::complex<float>> row) const;
  void add_pressure_row(std::uint32_t face, const Vec3& at, std::span<std::complex<float>> row) const;

 private:
  /// The contribution of a vertex' unknown to the six coefficients of a face's quadratic, 1, s, t, s^2, s t, t^2, in
  /// its frame.
  struct Share {
    std::uint32_t vertex;
    std::array<float, 6> of;
  };
  struct Frame {
    Vec3 origin, s, t;  ///< the length of s and t is the scale of the quadratic's coordinates
  };
  std::array<std::complex<double>, 6> quadratic(std::size_t face, std::span<const std::complex<float>> solution) const;

  std::vector<std::uint32_t> first_;
  std::vector<Share> shares_;
  std::vector<Frame> frames_;
  std::vector<std::array<std::uint32_t, 3>> corners_;
  std::vector<Vec3> positions_;
};

}  // namespace palpa::acoustics
