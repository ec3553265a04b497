// The sound that arrives at a body, known from few places on it.
//
// A mesh has far more vertices than the sound of distant sources has degrees of freedom. For each cluster of vertices,
// a few vertices are therefore chosen, and the right-hand sides of the boundary elements' equations at all vertices of
// the cluster are sums over them:
//
//   right side at v = sum over chosen s of share(v, s) b(s),   b(s) = p(s) + (i/k) dp/dn(s)
//
// with the incident sound p. The shares are those that are right, in the least squares, for point sources on a sphere
// around the cluster, a wavelength away from it. Waves from anywhere beyond this sphere are sums of these. The next
// vertex to choose is always the one that the others represent worst (Cheng, Gimbutas, Martinsson and Rokhlin 2005, "On
// the compression of low rank matrices"; by Cholesky's factors, since few digits are needed).
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
/// the loudest. Uses all cores; the same bytes for any number of threads. Throws GivenUp (base/parallel.hpp) soon after
/// `give_up` becomes true.
std::vector<FewPlaces> few_places(const RigidBody& body, double tolerance, const std::atomic<bool>* give_up = nullptr);

}  // namespace palpa::acoustics
