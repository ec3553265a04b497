// Rigid bodies with factored equations, kept for later requests of the same body.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "acoustics/bodies/rigid_body.hpp"
#include "geometry/mesh/mesh.hpp"

namespace palpa::acoustics {

/// For one thread at a time. The returned bodies may outlive the cache.
class BodyCache {
 public:
  /// Keeps the `most` most recently requested bodies: a finger of 4322 faces takes about 40 MB.
  explicit BodyCache(std::size_t most = 1) : most_(most) {}

  /// The body of this mesh and wave number. Returns a kept body if its vertices, triangles and wave number are
  /// identical; otherwise removes the oldest body and makes a new one. `mesh` and `give_up` as in RigidBody.
  std::shared_ptr<const RigidBody> of(const geometry::Mesh& mesh, double wave_number,
                                      const std::atomic<bool>* give_up = nullptr);

  /// The number of bodies that were made.
  std::uint64_t made() const { return made_; }

 private:
  std::size_t most_;
  std::uint64_t made_ = 0;
  std::vector<std::shared_ptr<const RigidBody>> kept_;  // the newest last
};

}  // namespace palpa::acoustics
