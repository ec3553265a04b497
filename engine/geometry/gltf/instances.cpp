#include "geometry/gltf/instances.hpp"

#include <fmt/format.h>

#include <cmath>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include "base/error.hpp"

namespace palpa::geometry::gltf {

std::vector<Transform> read_instances(const std::string& file, std::uint32_t node, const Instancing& instancing,
                                      const Values& values) {
  const auto fail = [&](std::size_t i, const char* what) {
    throw bad_input(file, fmt::format("node {}: instance {}: {}", node, i, what));
  };
  std::vector<Transform> T_node_instance(instancing.count, Transform(1));
  const auto read = [&](const std::optional<std::uint32_t>& accessor, std::size_t width, const auto& put) {
    if (!accessor) return;
    const std::vector<double> all = values.numbers(*accessor, width);
    for (std::size_t i = 0; i < instancing.count; ++i) {
      for (std::size_t k = 0; k < width; ++k) {
        if (!std::isfinite(all[i * width + k])) fail(i, "its place is not finite");
      }
      put(i, all.data() + i * width);
    }
  };
  read(instancing.rotation, 4, [&](std::size_t i, const double* q) {
    const glm::dquat turn(q[3], q[0], q[1], q[2]);
    const double norm = glm::dot(turn, turn);
    // Quantized rotations are slightly off.
    if (!(norm > 0.98 && norm < 1.02)) fail(i, "its rotation is not a unit quaternion");
    T_node_instance[i] = glm::mat4_cast(glm::normalize(turn));
  });
  read(instancing.scale, 3, [&](std::size_t i, const double* s) {
    for (int k = 0; k < 3; ++k)
      T_node_instance[i][k] *= s[k];
  });
  read(instancing.translation, 3,
       [&](std::size_t i, const double* t) { T_node_instance[i][3] = Vec4(t[0], t[1], t[2], 1); });
  return T_node_instance;
}

}  // namespace palpa::geometry::gltf
