// make_objects FOLDER: writes the paper's four objects, cube.glb, semi-sphere.glb, pyramid.glb and prism.glb, and the
// scenes of examples and docs, button-and-knob.glb and design.glb.
#include <array>
#include <filesystem>
#include <string>

#include "assets/generators/controls.hpp"
#include "assets/generators/objects.hpp"
#include "assets/generators/program.hpp"
#include "geometry/gltf/write.hpp"

int main(int argc, char** argv) {
  return palpa::assets::run_program([&] {
    const std::filesystem::path folder = palpa::assets::only_argument(argc, argv, "FOLDER");
    const std::array<palpa::geometry::SceneMesh, 4> objects{{{"cube", palpa::assets::make_cube()},
                                                             {"semi-sphere", palpa::assets::make_semi_sphere()},
                                                             {"pyramid", palpa::assets::make_pyramid()},
                                                             {"prism", palpa::assets::make_prism()}}};
    for (const auto& object : objects)
      palpa::geometry::write_glb(folder / (object.name + ".glb"), {&object, 1});
    palpa::geometry::write_glb(folder / "button-and-knob.glb", palpa::assets::make_button_and_knob());
    palpa::geometry::write_glb(folder / "design.glb", palpa::assets::make_design());
  });
}
