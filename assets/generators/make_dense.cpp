// make_dense FOLDER: writes the files for measuring the viewer's speed. dense.glb is a ball of 69,620 faces, bumpy like
// a scan. dense.ply has 20,000 skin points of a finger that presses it from above.
#include <cmath>
#include <filesystem>
#include <numbers>
#include <vector>

#include "assets/generators/program.hpp"
#include "geometry/files/ply.hpp"
#include "geometry/gltf/write.hpp"
#include "geometry/mesh/icosphere.hpp"

namespace {

using palpa::Vec3;

palpa::geometry::Mesh bumpy_ball() {
  constexpr double radius = 0.03;
  palpa::geometry::Mesh ball = palpa::geometry::icosphere(radius, 59);
  for (Vec3& p : ball.positions) {
    const Vec3 at = p / radius;
    const double bumps = std::sin(7 * at.x + 1) * std::sin(6 * at.y + 2) * std::sin(5 * at.z + 3);
    const double grain = std::sin(41 * at.x) * std::sin(37 * at.y) * std::sin(43 * at.z);
    p *= 1 + 0.09 * bumps + 0.012 * grain;
  }
  return ball;
}

/// Evenly around a cylinder with a round end, by the golden angle.
std::vector<Vec3> finger_above(double top) {
  constexpr int count = 20000;
  constexpr double radius = 0.008, length = 0.06, pressed = 0.0015;
  const double turn = std::numbers::pi * (3 - std::sqrt(5.0));
  std::vector<Vec3> points;
  for (int i = 0; i < count; ++i) {
    const double along = (length + radius) * (i + 0.5) / count;
    const double around = along < radius ? std::sqrt(radius * radius - (radius - along) * (radius - along)) : radius;
    points.emplace_back(around * std::cos(turn * i), top - pressed + along, around * std::sin(turn * i));
  }
  return points;
}

}  // namespace

int main(int argc, char** argv) {
  return palpa::assets::run_program([&] {
    const std::filesystem::path folder = palpa::assets::only_argument(argc, argv, "FOLDER");
    const palpa::geometry::SceneMesh ball{"dense", bumpy_ball()};
    double top = 0;
    for (const Vec3& p : ball.mesh.positions) {
      if (std::hypot(p.x, p.z) < 0.001) top = std::max(top, p.y);
    }
    palpa::geometry::write_glb(folder / "dense.glb", {&ball, 1});
    palpa::geometry::write_ply(folder / "dense.ply", finger_above(top), {});
  });
}
