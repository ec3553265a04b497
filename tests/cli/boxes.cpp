#include "boxes.hpp"

#include <glm/geometric.hpp>

#include "geometry/gltf_write.hpp"

namespace palpa::test {

geometry::SceneMesh make_box(const TiltedBox& box) {
  const Vec3 n = glm::normalize(box.normal);
  const Vec3 a = glm::normalize(box.along - n * glm::dot(n, box.along));
  const Vec3 b = glm::cross(n, a);
  geometry::SceneMesh scene{box.name, {}};
  // Corner i: bit 0 along, bit 1 across, bit 2 from the far face to the one through `on_face`; a, b, n are
  // right-handed.
  for (int i = 0; i < 8; ++i) {
    scene.mesh.positions.push_back(box.on_face + a * (i & 1 ? box.half_along : -box.half_along) +
                                   b * (i & 2 ? box.half_across : -box.half_across) - n * (i & 4 ? 0 : box.depth));
  }
  scene.mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                          {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return scene;
}

void write_boxes(const std::filesystem::path& file, const std::vector<TiltedBox>& boxes) {
  std::vector<geometry::SceneMesh> scene;
  scene.reserve(boxes.size());
  for (const TiltedBox& box : boxes)
    scene.push_back(make_box(box));
  geometry::write_glb(file, scene);
}

}  // namespace palpa::test
