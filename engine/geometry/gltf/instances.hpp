// Nodes that show their mesh many times: the extension EXT_mesh_gpu_instancing.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/math.hpp"
#include "geometry/gltf/values.hpp"
#include "geometry/gltf_document/check.hpp"

namespace palpa::geometry::gltf {

/// Translation, rotation and scale of each instance, in the node's coordinates. Throws bad_input naming `file`, the
/// node, and an instance whose values are not finite or whose rotation is not a unit quaternion (within 2 %).
std::vector<Transform> read_instances(const std::string& file, std::uint32_t node, const Instancing& instancing,
                                      const Values& values);

}  // namespace palpa::geometry::gltf
