#include "assets/generators/controls.hpp"

#include <cmath>
#include <numbers>

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

}  // namespace

std::vector<geometry::SceneMesh> make_button_and_knob() {
  geometry::Haptics button, knob;
  button.press_depth_m = 0.003;
  knob.foci = 8;
  knob.intensity = 0.7;
  return {{"button", disc({0, 0, 0}, 0.015, 0.012), button}, {"knob", disc({0.08, 0, 0}, 0.030, 0.020), knob}};
}

}  // namespace palpa::assets
