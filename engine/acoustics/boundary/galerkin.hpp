// Scattering by a rigid body as a matrix: Burton and Miller's equation (1971), discretised by Galerkin's method.
//
// The total pressure p on the body's surface S obeys, e^{-iwt}, n outwards, G = e^{ikR} / (4 pi R),
//
//   p/2 - K p - (i/k) N p = p_inc + (i/k) dp_inc/dn,
//   K p(x) = integral over S of dG/dn(y) p(y),   N p = d(K p)/dn(x),
//   -<f, N p> = double integral of G (curl_S f . curl_S p - k^2 n.n' f p),   curl_S f = n x grad f  (Maue 1949)
//
// The unknowns are the pressures at the mesh's vertices, p is linear on every patch, and the test functions f are the
// same hat functions. Pairs of patches are sampled by near_rules.hpp if they touch or are close, else by
// triangle_rules.hpp. The matrix is in single precision. docs/notes/boundary-elements.md has the reasons.
#pragma once

#include <atomic>
#include <complex>
#include <cstdint>
#include <span>

#include "acoustics/elements/patches.hpp"

namespace palpa::acoustics {

/// Replaces `matrix`, vertices x vertices, row-major, one row per test function. The same bytes for any number of
/// threads. Warns if faces that do not touch are too close to each other to be resolved. Throws GivenUp
/// (base/system/parallel.hpp) soon after `give_up` becomes true.
void assemble(const Patches& body, double wave_number, std::span<std::complex<float>> matrix,
              const std::atomic<bool>* give_up = nullptr);

/// Approximate memory that assemble() needs in addition to the matrix.
std::uint64_t assembly_bytes(const geometry::Mesh& mesh);

}  // namespace palpa::acoustics
