// Where two patches next to each other are sampled: by what they have in common, or by how far apart they are.
#pragma once

#include "acoustics/boundary/galerkin_kernels.hpp"
#include "acoustics/boundary/patches.hpp"

namespace palpa::acoustics {

class NearRules {
 public:
  NearRules();

  /// Samples of patches that touch, their singularity weighed away (triangle_rules.hpp), by their triangles in a welded
  /// mesh, which may be the same one; null where these have no corner in common.
  const PairTable* touching(const glm::uvec3& test, const glm::uvec3& trial) const;

  /// Samples of patches that do not touch: six on each, and where the patches are nearer to each other than 1.3 times
  /// the longer one's sides six on each of their quarters, or halves across of needles, and so on, a few times: `cut`
  /// is their place then. However patches are shaped that is bounded, at 2.4 million samples.
  /// `resolved` becomes false where that does not get there: patches less than about a twelfth of their sides apart.
  const PairTable& apart(const Patch& test, const Patch& trial, PairTable& cut, bool& resolved) const;

 private:
  PairTable same_, edge_[3][3], corner_[3][3], apart_;
};

}  // namespace palpa::acoustics
