// make_finger FOLDER: writes the finger as finger.glb and finger.ply, vertices and triangles in the same order.
#include <filesystem>

#include "assets/generators/finger.hpp"
#include "assets/generators/program.hpp"
#include "geometry/files/ply.hpp"
#include "geometry/gltf/write.hpp"

int main(int argc, char** argv) {
  return palpa::assets::run_program([&] {
    const std::filesystem::path folder = palpa::assets::only_argument(argc, argv, "FOLDER");
    const palpa::geometry::SceneMesh finger{"finger", palpa::assets::make_finger()};
    palpa::geometry::write_glb(folder / "finger.glb", {&finger, 1});
    palpa::geometry::write_ply(folder / "finger.ply", finger.mesh.positions, finger.mesh.triangles);
  });
}
