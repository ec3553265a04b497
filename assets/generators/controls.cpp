#include "assets/generators/controls.hpp"

#include <cmath>
#include <numbers>

#include "assets/generators/objects.hpp"
#include "assets/generators/shape.hpp"

namespace palpa::assets {
namespace {

/// An upright cylinder of 48 sides; the centre of its top is at `top`.
geometry::Mesh disc(const Vec3& top, double radius, double height) {
  constexpr std::uint32_t sides = 48;
  geometry::Mesh mesh;
  const auto add = [&](double y, std::uint32_t count) {
    const Ring ring{static_cast<std::uint32_t>(mesh.positions.size()), count};
    for (std::uint32_t i = 0; i < count; ++i) {
      const double angle = 2 * std::numbers::pi * i / sides, r = count == 1 ? 0 : radius;
      mesh.positions.push_back(top + Vec3(r * std::cos(angle), y, -r * std::sin(angle)));
    }
    return ring;
  };
  const Ring centre = add(0, 1), above = add(0, sides), below = add(-height, sides), floor = add(-height, 1);
  sew(mesh, centre, above);
  sew(mesh, above, below);
  sew(mesh, below, floor);
  round_to_float(mesh);
  return mesh;
}

geometry::Mesh placed(geometry::Mesh mesh, const Vec3& size, const Vec3& centre) {
  for (Vec3& position : mesh.positions)
    position = position * size + centre;
  round_to_float(mesh);
  return mesh;
}

geometry::Haptics clicking() {
  geometry::Haptics button;
  button.intensity = 0.5;
  button.press_depth_m = 0.003;
  button.click.emplace();
  return button;
}

}  // namespace

std::vector<geometry::SceneMesh> make_button_and_knob() {
  const geometry::Haptics button = clicking();
  geometry::Haptics knob;
  knob.foci = 8;
  knob.intensity = 0.7;
  return {{"button", disc({0, 0, 0}, 0.015, 0.012), button}, {"knob", disc({0.08, 0, 0}, 0.030, 0.020), knob}};
}

std::vector<geometry::SceneMesh> make_design() {
  geometry::Haptics spring, rough, smooth;
  spring.stiffness = {{0, 0.05}, {0.01, 1}};
  rough.texture = {0.2, 1, 0.6};
  rough.grain_m = 0.002;
  smooth.texture = {1, 0, 0.15};
  smooth.grain_m = 0.01;
  const geometry::Mesh round = disc({0, 0, 0}, 0.015, 0.012), cube = make_cube();
  const Vec3 flat(1, 0.25, 1);
  return {{"button", round, clicking()},
          {"spring", placed(round, Vec3(1), {0.05, 0, 0}), spring},
          {"rough", placed(cube, flat, {-0.05, 0, 0}), rough},
          {"smooth", placed(cube, flat, {0, 0, -0.05}), smooth}};
}

}  // namespace palpa::assets
