// Scattering by a rigid body as a matrix: Burton and Miller's equation (1971), discretised by Galerkin's method.
//
// The total pressure p on the body's surface S obeys, e^{-iwt}, n outwards, G = e^{ikR} / (4 pi R),
//
//   p/2 - K p - (i/k) N p = p_inc + (i/k) dp_inc/dn,
//   K p(x) = integral over S of dG/dn(y) p(y),   N p = d(K p)/dn(x),
//
// This equation has exactly one solution for every k. For a sphere, the equation with K alone has no unique solution if
// k a is a zero of j_n, and the equation with N alone has no unique solution if k a is a zero of j_n'. The body's
// inside then resonates. 5.7635 and 5.9404 are the zeros nearest to the k a of a fingertip. p is linear on every patch
// and continuous: the unknowns are the pressures at the mesh's vertices, and the test functions are the same hat
// functions. The singularity of N is then no stronger than 1/R (Maue 1949):
//
//   -<f, N p> = double integral of G (curl_S f . curl_S p - k^2 n.n' f p),   curl_S f = n x grad f.
//
// Pairs of patches that touch are sampled by rules that remove the singularity, close pairs by six samples on each
// patch, if necessary after subdivision (near_rules.hpp), and all others by three (triangle_rules.hpp). Single
// precision is enough: the matrix is well conditioned, and its error of 4e-6 is far below the error of linear elements
// (docs/notes/boundary-elements.md).
#pragma once

#include <atomic>
#include <complex>
#include <cstdint>
#include <span>

#include "acoustics/elements/patches.hpp"

namespace palpa::acoustics {

/// Replaces `matrix`, vertices x vertices, row-major, one row per test function. The same bytes for any number of
/// threads. Warns if faces that do not touch are too close to each other to be resolved. Throws GivenUp
/// (base/parallel.hpp) soon after `give_up` becomes true.
void assemble(const Patches& body, double wave_number, std::span<std::complex<float>> matrix,
              const std::atomic<bool>* give_up = nullptr);

/// Approximate memory that assemble() needs in addition to the matrix.
std::uint64_t assembly_bytes(const geometry::Mesh& mesh);

}  // namespace palpa::acoustics
