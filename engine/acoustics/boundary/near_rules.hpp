// Sampling rules for two neighbouring patches, by shared corners or by distance.
#pragma once

#include "acoustics/boundary/galerkin_kernels.hpp"
#include "acoustics/elements/patches.hpp"

namespace palpa::acoustics {

class NearRules {
 public:
  NearRules();

  /// Samples of patches that touch, with their singularity removed (triangle_rules.hpp). The patches are given as
  /// triangles of one welded mesh and may be the same one. Null if they have no corner in common.
  const PairTable* touching(const glm::uvec3& test, const glm::uvec3& trial) const;

  /// Samples of patches that do not touch: six on each. If the patches are nearer to each other than 1.3 times the
  /// longer one's sides, they are divided into quarters (needles into halves across), with six samples on each, and so
  /// on, a few times; the samples are then stored in `cut`. The number of samples is at most 2.4 million for patches of
  /// any shape.
  /// `resolved` becomes false if this does not suffice: the patches are less than about a twelfth of their sides apart.
  const PairTable& apart(const Patch& test, const Patch& trial, PairTable& cut, bool& resolved) const;

 private:
  PairTable same_, edge_[3][3], corner_[3][3], apart_;
};

}  // namespace palpa::acoustics
