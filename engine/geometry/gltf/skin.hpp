// A mesh on its skeleton, in the pose that the file gives.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "base/math.hpp"

namespace palpa::geometry::gltf {

/// Four joints of each vertex and their weights. A primitive has one or more such sets.
struct Influence {
  std::vector<std::uint32_t> joints;  ///< 4 per vertex
  std::vector<double> weights;        ///< 4 per vertex
};

/// glTF 2.0 section 3.7.3: each position becomes the weighted mean of its images under the joints' matrices. Weights
/// are normalised. Returns the first vertex whose weights have no positive sum or that names a joint without a matrix;
/// nullopt if there is none.
std::optional<std::size_t> apply_skin(std::vector<Vec3>& positions, const std::vector<Influence>& influences,
                                      const std::vector<Transform>& T_world_bind);

}  // namespace palpa::geometry::gltf
