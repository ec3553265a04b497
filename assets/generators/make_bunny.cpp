// make_bunny BUNNY.js FOLDER: writes the bunny, 100 mm high, as bunny.glb. Also writes fingers.ply: one finger that
// presses its back from above and one that presses an ear from the side.
#include <filesystem>

#include "assets/generators/bunny.hpp"
#include "assets/generators/finger.hpp"
#include "assets/generators/program.hpp"
#include "base/error.hpp"
#include "geometry/files/ply.hpp"
#include "geometry/gltf/write.hpp"

int main(int argc, char** argv) {
  return palpa::assets::run_program([&] {
    using palpa::Vec3;
    if (argc != 3) throw palpa::bad_usage(std::string("usage: ") + argv[0] + " BUNNY.js FOLDER");
    const std::filesystem::path folder = argv[2];
    const palpa::geometry::SceneMesh bunny{"bunny", palpa::assets::stand_up(palpa::assets::read_bunny(argv[1]), 0.1)};
    const palpa::geometry::Mesh finger = palpa::assets::make_finger();
    palpa::geometry::Mesh both =
        palpa::assets::press_finger(finger, bunny.mesh, Vec3(0.026, 0.06, 0.006), Vec3(-0.4, -1, -0.25), 0.003);
    palpa::geometry::append(
        both, palpa::assets::press_finger(finger, bunny.mesh, Vec3(-0.035, 0.089, -0.028), Vec3(1, -0.2, -0.2), 0.003));
    palpa::geometry::write_glb(folder / "bunny.glb", {&bunny, 1});
    palpa::geometry::write_ply(folder / "fingers.ply", both.positions, both.triangles);
  });
}
