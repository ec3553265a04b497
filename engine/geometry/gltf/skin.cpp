#include "geometry/gltf/skin.hpp"

namespace palpa::geometry::gltf {

std::optional<std::size_t> apply_skin(std::vector<Vec3>& positions, const std::vector<Influence>& influences,
                                      const std::vector<Transform>& T_world_bind) {
  for (std::size_t v = 0; v < positions.size(); ++v) {
    Vec3 sum(0);
    double total = 0;
    for (const Influence& influence : influences) {
      for (std::size_t i = 4 * v; i < 4 * v + 4; ++i) {
        const double weight = influence.weights[i];
        // Joints with weight 0 may have any index.
        if (weight == 0) continue;
        if (!(weight > 0) || influence.joints[i] >= T_world_bind.size()) return v;
        sum += weight * transform_point(T_world_bind[influence.joints[i]], positions[v]);
        total += weight;
      }
    }
    if (!(total > 0)) return v;
    positions[v] = sum / total;
  }
  return std::nullopt;
}

}  // namespace palpa::geometry::gltf
