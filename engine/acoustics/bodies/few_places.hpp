// The sound that arrives at a body, known from few places on it: far fewer than a mesh has vertices.
//
//   right side at v = sum over chosen s of share(v, s) b(s),   b(s) = p(s) + (i/k) dp/dn(s)
//
// for the right-hand sides of the boundary elements' equations, with the incident sound p. For each cluster of
// vertices, the shares are right, in the least squares, for point sources on a sphere around it, a wavelength away.
// Waves from anywhere beyond are sums of these. Chooses next the vertex that the others represent worst (Cheng,
// Gimbutas, Martinsson and Rokhlin 2005, by Cholesky's factors, since few digits are needed).
#pragma once

#include <atomic>
#include <complex>
#include <cstdint>
#include <vector>

#include "acoustics/bodies/rigid_body.hpp"

namespace palpa::acoustics {

/// Vertices near each other, and some of them that stand for all.
struct FewPlaces {
  std::vector<std::uint32_t> vertices, chosen;
  std::vector<std::complex<float>> shares;  ///< entry [chosen * vertices + vertex]
};

/// For all vertices of a body, cluster by cluster. The vertices that are represented worst are off by `tolerance` of
/// the loudest. Uses all cores; the same bytes for any number of threads. Throws GivenUp (base/system/parallel.hpp)
/// soon after `give_up` becomes true.
std::vector<FewPlaces> few_places(const RigidBody& body, double tolerance, const std::atomic<bool>* give_up = nullptr);

}  // namespace palpa::acoustics
