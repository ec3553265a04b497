// Boxes as glTF models, placed where a test needs a solid, and a ball that is prepared for seconds.
#pragma once

#include <filesystem>
#include <vector>

#include "base/math.hpp"
#include "geometry/gltf/gltf.hpp"

namespace palpa::test {

/// A box with one face through `on_face`, whose outward normal is `normal`. It is `depth` thick behind that face.
/// `along` is made a direction in that face. The box reaches `half_along` to both sides along it, and `half_across`
/// across it.
struct TiltedBox {
  std::string name;
  Vec3 on_face, normal, along;
  double half_along, half_across, depth;
};
geometry::SceneMesh make_box(const TiltedBox& box);

/// A concave ball, 10 cm wide, of about 2 rings^2 triangles.
geometry::Mesh bumpy_ball(int rings);

void write_boxes(const std::filesystem::path& file, const std::vector<TiltedBox>& boxes);

}  // namespace palpa::test
