// A mesh on its skeleton, in the pose of the file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "base/math.hpp"

namespace palpa::geometry::gltf {

/// Four joints of each vertex and their weights; a primitive has one such set or more.
struct Influence {
  std::vector<std::uint32_t> joints;  ///< 4 per vertex
  std::vector<double> weights;        ///< 4 per vertex
};

/// glTF 2.0 section 3.7.3: each position becomes the mean, by weight, of where each joint's matrix takes it. Weights
/// are normalised. Returns the first vertex whose weights have no positive sum or that names a joint without matrix;
/// nullopt if all is well.
std::optional<std::size_t> apply_skin(std::vector<Vec3>& positions, const std::vector<Influence>& influences,
                                      const std::vector<Transform>& T_world_bind);

}  // namespace palpa::geometry::gltf
