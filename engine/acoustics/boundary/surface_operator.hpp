// The interface of the boundary elements' system of equations: a map from right-hand sides to unknowns, made once per
// body and wave number. Only a dense implementation exists; another one could compress distant parts of the surface.
#pragma once

#include <atomic>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "acoustics/boundary/patches.hpp"

namespace palpa::acoustics {

/// Selects the system: A x = b, or A^T x = b (transposed, not conjugated), which is sound propagating backwards.
enum class Way { forth, back };

class SurfaceOperator {
 public:
  virtual ~SurfaceOperator() = default;
  /// One per vertex of the mesh.
  virtual std::size_t unknowns() const = 0;
  /// Replaces the right-hand sides in `columns`, one after the other, by their solutions. Any number of threads may
  /// call it at a time; the same bytes for any number of threads.
  virtual void solve(Way way, std::span<std::complex<float>> columns) const = 0;
};

/// The whole matrix (galerkin.hpp) and its factors: each solution then costs two passes over it. Factoring takes 8/3
/// vertices^3 operations. Throws GivenUp (base/parallel.hpp) soon after `give_up` becomes true.
std::unique_ptr<SurfaceOperator> make_dense_operator(const Patches& body, double wave_number,
                                                     const std::atomic<bool>* give_up = nullptr);

/// The maximum memory that making it takes.
std::uint64_t dense_operator_bytes(const geometry::Mesh& body);

}  // namespace palpa::acoustics
