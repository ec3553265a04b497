// Rigid bodies whose equations are factored, kept for whoever asks for the same again.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "acoustics/bodies/rigid_body.hpp"
#include "geometry/mesh/mesh.hpp"

namespace palpa::acoustics {

/// For one thread at a time; what it gives out lives on without it.
class BodyCache {
 public:
  /// Keeps the `most` bodies that were asked for last: a finger of 4322 faces takes some 40 MB.
  explicit BodyCache(std::size_t most = 1) : most_(most) {}

  /// The body of this mesh and wave number: a kept one where its vertices, triangles and wave number are the very same,
  /// else a new one, made when the oldest has made way. `mesh` and `give_up` as RigidBody takes them.
  std::shared_ptr<const RigidBody> of(const geometry::Mesh& mesh, double wave_number,
                                      const std::atomic<bool>* give_up = nullptr);

  /// How many it had to make.
  std::uint64_t made() const { return made_; }

 private:
  std::size_t most_;
  std::uint64_t made_ = 0;
  std::vector<std::shared_ptr<const RigidBody>> kept_;  // the newest last
};

}  // namespace palpa::acoustics
