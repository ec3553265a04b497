// What grows. Everything else is a fingertip 3 mm deep in a solid, with the paper's array.
#include <glm/gtc/matrix_transform.hpp>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>
#include <random>
#include <utility>

#include "bench/growth.hpp"
#include "bench/shapes.hpp"
#include "geometry/files/ply.hpp"
#include "sensing/synthetic.hpp"
#include "setup/files/assets.hpp"
#include "setup/sessions/load.hpp"

namespace palpa::bench {
namespace {

constexpr double deep_m = 3e-3;
constexpr std::uint32_t usual_points = 20'000;

session::SessionSetting setting_of(std::vector<geometry::Solid> solids, array::Layout layout) {
  return {.solids = std::move(solids),
          .layout = std::move(layout),
          .events = std::nullopt,
          .predict = {session::Predict::automatic, 20e-3}};
}

std::vector<geometry::Solid> cube() {
  return setup::load_solids(setup::find_asset("cube.glb"), {});
}

GrowthCase with_points(session::SessionSetting setting, const std::vector<glm::vec3>& points) {
  GrowthCase made{std::move(setting), {}};
  made.frame.points = sensing::numbered(points);
  made.frame.pushed = true;
  return made;
}

/// The images of cameras that see the fingertip.
GrowthCase with_cameras(session::SessionSetting setting, std::vector<sensing::Camera> cameras) {
  const geometry::Ply finger = geometry::read_ply(setup::find_asset("finger.ply"));
  const geometry::Mesh skin{finger.positions, finger.triangles};
  Transform lowered(1.0);
  lowered[3] = Vec4(0, -deep_m, 0, 1);
  setting.cameras = std::move(cameras);
  GrowthCase made{std::move(setting), {}};
  sensing::SyntheticRig rig(made.setting.cameras, {}, sensing::Noise::d415, 1);
  const sensing::Posed posed{&skin, lowered};
  rig.render(std::span(&posed, 1), 0, made.frame);
  return made;
}

GrowthCase faces(std::uint32_t size) {
  const setup::PosedRig rig = setup::load_posed_rig({});
  return with_cameras(setting_of(geometry::make_solids({"bench", {{"ball", dented_ball(size)}}}), rig.layout),
                      rig.rig.cameras);
}

GrowthCase skin_points(std::uint32_t size) {
  return with_points(setting_of(cube(), setup::load_posed_layout("paper")), finger_points(size, -deep_m));
}

/// Patches of skin below the top of a box, side by side.
GrowthCase fingers(std::uint32_t size) {
  std::mt19937 random(size);
  std::uniform_real_distribution<double> across(-5e-3, 5e-3), deep(1e-5, 1.4e-3);
  std::vector<glm::vec3> points;
  for (std::uint32_t finger = 0; finger < size; ++finger) {
    const double x = 0.02 * (finger % 8), z = 0.02 * (finger / 8);
    for (int i = 0; i < 300; ++i)
      points.emplace_back(x + across(random) - 0.07, -deep(random), z + across(random) - 0.07);
  }
  return with_points(setting_of(box_solid(Vec3(-0.15, -0.1, -0.15), Vec3(0.15, 0, 0.15)),  //
                                setup::load_posed_layout("paper")),
                     points);
}

GrowthCase foci(std::uint32_t size) {
  GrowthCase made = skin_points(usual_points);
  made.setting.touch.foci = size;
  return made;
}

/// Boards of AUTD3 in a square, all in one plane.
GrowthCase transducers(std::uint32_t size) {
  const array::Layout board = setup::load_posed_layout("autd3");
  const auto boards = size / static_cast<std::uint32_t>(board.transducers.size());
  const auto columns = static_cast<std::uint32_t>(std::ceil(std::sqrt(boards)));
  array::Layout layout = board;
  layout.transducers.clear();
  layout.boards.clear();
  for (std::uint32_t i = 0; i < boards; ++i) {
    const double middle = (columns - 1) / 2.0;
    const Vec3 offset(0.2 * (i % columns - middle), 0, 0.16 * (i / columns - middle));
    for (array::Transducer transducer : board.transducers) {
      transducer.position += offset;
      layout.transducers.push_back(transducer);
    }
  }
  return with_points(setting_of(cube(), std::move(layout)), finger_points(usual_points, -deep_m));
}

/// The rig's cameras, and copies of them turned about the vertical.
GrowthCase cameras(std::uint32_t size) {
  const setup::PosedRig rig = setup::load_posed_rig({});
  std::vector<sensing::Camera> all;
  for (std::uint32_t i = 0; i < size; ++i) {
    sensing::Camera camera = rig.rig.cameras[i % rig.rig.cameras.size()];
    const auto turn = static_cast<double>(i / rig.rig.cameras.size()) * 2 * std::numbers::pi / 9;
    camera.T_world_camera = glm::rotate(Transform(1.0), turn, Vec3(0, 1, 0)) * camera.T_world_camera;
    camera.name += std::to_string(i);
    all.push_back(std::move(camera));
  }
  return with_cameras(setting_of(cube(), rig.layout), std::move(all));
}

/// A cube of 40 mm, which the finger touches, and around it cubes of 5 mm, 6 mm apart: the nearest places of a square.
GrowthCase solids(std::uint32_t size) {
  constexpr double apart = 6e-3, half = 2.5e-3;
  const int reach = 6 + static_cast<int>(std::sqrt(size) / 2);
  std::vector<Vec3> places;
  for (int column = -reach; column <= reach; ++column) {
    for (int row = -reach; row <= reach; ++row) {
      if (std::max(std::abs(column), std::abs(row)) > 4) places.emplace_back(apart * column, 0, apart * row);
    }
  }
  std::stable_sort(places.begin(), places.end(),
                   [](const Vec3& a, const Vec3& b) { return glm::dot(a, a) < glm::dot(b, b); });
  geometry::Scene scene{"bench", {{"touched", box_mesh(Vec3(-0.02, -0.04, -0.02), Vec3(0.02, 0, 0.02))}}};
  for (std::uint32_t i = 0; i + 1 < size; ++i) {
    const Vec3& top = places.at(i);
    scene.meshes.push_back({"cube" + std::to_string(i), box_mesh(top - Vec3(half, 2 * half, half),  //
                                                                 top + Vec3(half, 0, half))});
  }
  const setup::PosedRig rig = setup::load_posed_rig({});
  return with_cameras(setting_of(geometry::make_solids(scene), rig.layout), rig.rig.cameras);
}

const GrowthAxis axes[]{
    {"faces", {100, 1'000, 10'000, 100'000, 1'000'000}, faces},
    {"skin points", {10'000, 40'000, 100'000, 400'000, 1'000'000, 4'000'000}, skin_points},
    {"fingers", {1, 2, 4, 8, 16, 32, 64}, fingers},
    {"foci", {1, 2, 4, 8, 16, 32, 64}, foci},
    {"transducers", {249, 996, 3'984, 8'964, 15'936}, transducers},
    {"cameras", {1, 2, 3, 4, 6, 8}, cameras},
    {"solids", {1, 10, 100, 1'000, 10'000}, solids},
};

}  // namespace

std::span<const GrowthAxis> growth_axes() {
  return axes;
}

}  // namespace palpa::bench
