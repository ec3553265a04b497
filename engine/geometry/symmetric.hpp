// Eigenvalues and eigenvectors of small symmetric matrices, in double precision.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

namespace palpa::geometry {

template <std::size_t n>
using Matrix = std::array<std::array<double, n>, n>;

template <std::size_t n>
struct EigenPairs {
  std::array<double, n> values;
  Matrix<n> vectors;  ///< vectors[i] belongs to values[i]; orthonormal
};

/// Jacobi's method: rotations in the planes of two coordinates until the off-diagonal elements vanish. Unordered.
template <std::size_t n>
EigenPairs<n> eigen_of(Matrix<n> a) {
  EigenPairs<n> out{};
  for (std::size_t i = 0; i < n; ++i)
    out.vectors[i][i] = 1;
  for (int sweep = 0; sweep < 60; ++sweep) {
    double beside = 0, diagonal = 0;
    for (std::size_t i = 0; i < n; ++i) {
      diagonal += a[i][i] * a[i][i];
      for (std::size_t j = i + 1; j < n; ++j)
        beside += a[i][j] * a[i][j];
    }
    if (beside <= 1e-30 * diagonal) break;
    for (std::size_t p = 0; p < n; ++p) {
      for (std::size_t q = p + 1; q < n; ++q) {
        if (a[p][q] == 0) continue;
        const double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
        const double t = std::copysign(1.0, theta) / (std::abs(theta) + std::hypot(theta, 1.0));
        const double c = 1 / std::hypot(t, 1.0), s = t * c;
        for (std::size_t k = 0; k < n; ++k) {
          const double kp = a[k][p], kq = a[k][q];
          a[k][p] = c * kp - s * kq;
          a[k][q] = s * kp + c * kq;
        }
        for (std::size_t k = 0; k < n; ++k) {
          const double pk = a[p][k], qk = a[q][k];
          a[p][k] = c * pk - s * qk;
          a[q][k] = s * pk + c * qk;
          const double vp = out.vectors[p][k], vq = out.vectors[q][k];
          out.vectors[p][k] = c * vp - s * vq;
          out.vectors[q][k] = s * vp + c * vq;
        }
      }
    }
  }
  for (std::size_t i = 0; i < n; ++i)
    out.values[i] = a[i][i];
  return out;
}

}  // namespace palpa::geometry
