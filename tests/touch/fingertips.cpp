#include "touch/fingertips.hpp"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <numbers>

#include "geometry/gltf/gltf.hpp"
#include "sensing/rig.hpp"
#include "sensing/synthetic.hpp"
#include "support/hand_skin.hpp"
#include "support/shared_data.hpp"

namespace palpa::touch::test {
namespace {

using palpa::test::source_file;

double radians(double degrees) {
  return degrees * std::numbers::pi / 180;
}

const geometry::Mesh& finger() {
  return palpa::test::finger_skin().mesh;
}

Transform pose_of(const Press& press) {
  const double tilt = radians(press.tilt_deg), turn = radians(press.azimuth_deg);
  const Vec3 lean(std::cos(turn), 0, std::sin(turn));
  const double up = press.from_below ? -1 : 1;
  const Vec3 body = Vec3(0, up * std::cos(tilt), 0) + std::sin(tilt) * lean;
  const Vec3 side = glm::normalize(glm::cross(lean, Vec3(0, 1, 0)));
  const double s = press.scale;
  Transform T(Vec4(side * s, 0), Vec4(body * s, 0), Vec4(glm::cross(side, body) * s, 0), Vec4(0, 0, 0, 1));
  // The pad, not the finger's other end, is what touches.
  constexpr double pad = 14e-3;
  Vec3 foremost(0, up, 0);
  for (const Vec3& p : finger().positions) {
    const Vec3 world = transform_direction(T, p);
    if (p.y < pad && up * world.y < up * foremost.y) foremost = world;
  }
  T[3] = Vec4(Vec3(press.x, press.y - up * press.press_m, press.z) - foremost, 1);
  return T;
}

/// The press that each contact belongs to: the one whose finger's surface is nearest.
std::vector<std::uint32_t> owners(const Touch& touch, const std::vector<Press>& presses) {
  std::vector<std::uint32_t> out;
  for (const Contact& contact : touch.contacts) {
    double nearest = 1e300;
    std::uint32_t owner = 0;
    for (std::uint32_t f = 0; f < presses.size(); ++f) {
      const Transform T = pose_of(presses[f]);
      for (const Vec3& p : finger().positions) {
        const double apart = glm::distance(transform_point(T, p), Vec3(contact.position));
        if (apart >= nearest) continue;
        nearest = apart;
        owner = f;
      }
    }
    out.push_back(owner);
  }
  return out;
}

}  // namespace

std::vector<sensing::Camera> paper_cameras(int count) {
  auto cameras = sensing::load_rig(source_file("assets/rigs/paper.toml")).cameras;
  cameras.resize(static_cast<std::size_t>(count));
  return cameras;
}

std::vector<sensing::Camera> ring_of_cameras(int count, double elevation_deg, double azimuth_deg, double distance_m) {
  std::vector<sensing::Camera> cameras;
  for (int i = 0; i < count; ++i) {
    const double up = radians(elevation_deg), around = radians(azimuth_deg + 360.0 * i / count);
    const Vec3 eye = distance_m * Vec3(std::cos(up) * std::cos(around), std::sin(up), std::cos(up) * std::sin(around));
    const Vec3 forward = -glm::normalize(eye), right = glm::normalize(glm::cross(forward, Vec3(0, 1, 0)));
    sensing::Camera camera = paper_cameras(1)[0];
    camera.T_world_camera =
        Transform(Vec4(right, 0), Vec4(glm::cross(forward, right), 0), Vec4(forward, 0), Vec4(eye, 1));
    cameras.push_back(camera);
  }
  return cameras;
}

std::vector<geometry::Solid> object(const std::string& name) {
  return geometry::make_solids(geometry::load_gltf(source_file("assets/" + name + ".glb")));
}

std::vector<sensing::DepthFrame> images_of(const std::vector<sensing::Camera>& cameras,
                                           const std::vector<Press>& presses, std::uint64_t seed) {
  sensing::SyntheticRig rig(cameras, {}, sensing::Noise::d415, seed);
  std::vector<sensing::Posed> skin;
  for (const Press& press : presses)
    skin.push_back({&finger(), pose_of(press)});
  sensing::FrameSet set;
  rig.render(skin, seed, set);
  return set.frames;
}

std::vector<int> presses_in_fingers(const Touch& touch, const std::vector<Press>& presses) {
  const std::vector<std::uint32_t> owner = owners(touch, presses);
  std::vector<int> out;
  for (std::uint32_t f = 0; f < touch.finger_count; ++f) {
    std::vector<std::size_t> share(presses.size());
    for (const std::uint32_t i : touch.fingers[f].contacts)
      ++share[owner[i]];
    const std::size_t all = touch.fingers[f].contacts.size();
    out.push_back(static_cast<int>(
        std::count_if(share.begin(), share.end(), [&](std::size_t contacts) { return contacts * 10 > all; })));
  }
  return out;
}

Trial random_trial(std::mt19937& random, int cameras, double elevation_deg, const std::string& object,
                   std::size_t fingers) {
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  constexpr std::array<double, 4> tilts{0, 20, 45, 65};
  Trial trial;
  trial.object = object;
  trial.cameras =
      elevation_deg == paper_rig ? paper_cameras(cameras) : ring_of_cameras(cameras, elevation_deg, between(0, 360));
  Press press{.press_m = between(1e-3, 6e-3), .tilt_deg = tilts[random() % 4], .azimuth_deg = between(0, 360)};
  const double turn = radians(press.azimuth_deg), apart = fingers == 2 ? between(19e-3, 22.5e-3) : 0;
  for (std::size_t f = 0; f < fingers; ++f) {
    const double side = f == 0 ? -apart / 2 : apart / 2;
    press.x = -std::sin(turn) * side;
    press.z = std::cos(turn) * side;
    trial.presses.push_back(press);
    press.press_m = std::clamp(press.press_m + between(-1e-3, 1e-3), 1e-3, 6e-3);
  }
  trial.images = images_of(trial.cameras, trial.presses, random());
  return trial;
}

}  // namespace palpa::touch::test
