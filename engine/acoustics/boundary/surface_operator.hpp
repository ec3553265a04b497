// The boundary elements' system of equations as whoever solves it sees it: a map from right-hand sides to unknowns,
// made once per body and wave number. The dense one is there; one that compresses far parts of the surface would be
// another.
#pragma once

#include <atomic>
#include <complex>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "acoustics/boundary/patches.hpp"

namespace palpa::acoustics {

/// Which of its two systems: A x = b, or A^T x = b (transposed, not conjugated), which is the sound going backwards.
enum class Way { forth, back };

class SurfaceOperator {
 public:
  virtual ~SurfaceOperator() = default;
  /// One per vertex of the mesh.
  virtual std::size_t unknowns() const = 0;
  /// Replaces right-hand sides, one after the other in `columns`, by their solutions. Any number of threads may call
  /// it at a time; the same bytes for any number of threads.
  virtual void solve(Way way, std::span<std::complex<float>> columns) const = 0;
};

/// The whole matrix (galerkin.hpp) and its factors: a solution then costs two passes over it. Factoring takes 8/3
/// vertices^3 operations. Throws GivenUp (base/parallel.hpp) soon after `give_up` became true.
std::unique_ptr<SurfaceOperator> make_dense_operator(const Patches& body, double wave_number,
                                                     const std::atomic<bool>* give_up = nullptr);

/// Memory that it takes at most while it is made.
std::uint64_t dense_operator_bytes(const geometry::Mesh& body);

}  // namespace palpa::acoustics
