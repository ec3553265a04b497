#include "cli/support/boxes.hpp"

#include <cmath>
#include <glm/geometric.hpp>

#include "geometry/gltf/write.hpp"
#include "support/shapes.hpp"

namespace palpa::test {

geometry::SceneMesh make_box(const TiltedBox& box) {
  const Vec3 n = glm::normalize(box.normal);
  const Vec3 a = glm::normalize(box.along - n * glm::dot(n, box.along));
  const Vec3 b = glm::cross(n, a);
  // a, b, n are right-handed.
  return {box.name,
          transformed(test::box({-box.half_along, -box.half_across, -box.depth}, {box.half_along, box.half_across, 0}),
                      [&](const Vec3& p) { return box.on_face + a * p.x + b * p.y + n * p.z; })};
}

geometry::Mesh bumpy_ball(int rings) {
  geometry::Mesh ball = sphere(0.05, rings, rings);
  for (Vec3& p : ball.positions)
    p *= 1 + 0.1 * std::sin(120 * p.x) * std::sin(130 * p.y);
  return ball;
}

void write_boxes(const std::filesystem::path& file, const std::vector<TiltedBox>& boxes) {
  std::vector<geometry::SceneMesh> scene;
  scene.reserve(boxes.size());
  for (const TiltedBox& box : boxes)
    scene.push_back(make_box(box));
  geometry::write_glb(file, scene);
}

}  // namespace palpa::test
