// The interface of the boundary elements' system of equations: a map from right-hand sides to unknowns, made once per
// body and wave number. Small bodies have a dense matrix with its factors, large ones the compressed matrix of
// compressed/body_operator.hpp.
#pragma once

#include <atomic>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "acoustics/elements/patches.hpp"

namespace palpa::acoustics {

/// Selects the system: A x = b, or A^T x = b (transposed, not conjugated), which is sound propagating backwards.
enum class Way { forth, back };

/// How solutions were found. Dense factors need no iteration, and their residual is not computed.
struct SolveReport {
  std::uint32_t iterations = 0;  ///< products of the matrix with all right-hand sides that are solved together
  double residual = 0;           ///< the largest |b - A x| / |b| of any right-hand side
};

class SurfaceOperator {
 public:
  virtual ~SurfaceOperator() = default;
  /// One per vertex of the mesh.
  virtual std::size_t unknowns() const = 0;
  /// Whether solve() iterates.
  virtual bool iterates() const = 0;
  /// Replaces the right-hand sides in `columns`, one after the other, by their solutions. Any number of threads may
  /// call it at a time; the same bytes for any number of threads. If the iterations do not converge, throws failure()
  /// that gives the residual. Iterations end with GivenUp (base/system/parallel.hpp) soon after `give_up` becomes true.
  virtual SolveReport solve(Way way, std::span<std::complex<float>> columns,
                            const std::atomic<bool>* give_up = nullptr) const = 0;
};

/// The whole matrix (galerkin.hpp) and its factors: each solution then costs two passes over it. Factoring takes 8/3
/// vertices^3 operations. Throws GivenUp (base/system/parallel.hpp) soon after `give_up` becomes true.
std::unique_ptr<SurfaceOperator> make_dense_operator(const Patches& body, double wave_number,
                                                     const std::atomic<bool>* give_up = nullptr);

/// The maximum memory that making it takes.
std::uint64_t dense_operator_bytes(const geometry::Mesh& body);

}  // namespace palpa::acoustics
