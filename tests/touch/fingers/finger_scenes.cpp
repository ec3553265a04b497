#include "touch/fingers/finger_scenes.hpp"

#include <algorithm>
#include <glm/geometric.hpp>
#include <numbers>

#include "assets/generators/hand.hpp"
#include "sensing/synthetic.hpp"
#include "support/hand_skin.hpp"
#include "touch/fingertips.hpp"
#include "touch/harness.hpp"

namespace palpa::touch::test {
namespace {

using palpa::test::finger_skin;
using palpa::test::hand_skin;
using palpa::test::pressed;
using palpa::test::rotation;

double radians(double degrees) {
  return degrees * std::numbers::pi / 180;
}

std::vector<sensing::Camera> ring(std::mt19937& random, int count) {
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  const double around = between(0, 360), up = between(-60, -25), distance = between(0.4, 0.6);
  return ring_of_cameras(count, up, around, distance);
}

std::vector<Vec3> some_of(const geometry::Mesh& mesh, const Transform& T) {
  std::vector<Vec3> points;
  for (const Vec3& p : mesh.positions) {
    const Vec3 world = transform_point(T, p);
    if (world.y < 4e-3) points.push_back(world);
  }
  return points;
}

}  // namespace

const char* name_of(SceneKind kind) {
  constexpr const char* names[] = {"pairs",
                                   "fives",
                                   "pairs, deep",
                                   "fives, deep",
                                   "hands, deep",
                                   "single fingertips",
                                   "fingers that lie flat",
                                   "palms",
                                   "rims before a wall"};
  return names[static_cast<int>(kind)];
}

FingerScene random_scene(std::mt19937& random, SceneKind kind, int cameras) {
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  const geometry::Mesh& finger = finger_skin().mesh;
  FingerScene scene;
  scene.solid = box({-0.2, -0.15, -0.2}, {0.2, 0, 0.2}, "box");
  scene.cameras = ring(random, cameras);
  const double azimuth = radians(between(0, 360));
  const Transform turn = rotation({0, 1, 0}, azimuth);
  if (kind == SceneKind::rims) {
    // Fingers 18 mm thick that lie 18 mm before the wall.
    scene.solid = box({-0.2, 19.5e-3, -0.2}, {0.2, 29e-3, 0.2}, "plate");
    scene.parameters.delta_m = 5e-3;  // all of it
    static const geometry::Mesh wall{{{-0.3, 0.036, -0.3}, {0.3, 0.036, -0.3}, {0.3, 0.036, 0.3}, {-0.3, 0.036, 0.3}},
                                     {{0, 1, 2}, {0, 2, 3}}};
    for (const double x : {-0.06, -0.02, 0.02, 0.06}) {
      Transform T = rotation({1, 0, 0}, std::numbers::pi / 2);
      T[3] = Vec4(x, 0, -0.03, 1);
      scene.skin.push_back({&finger, pressed(finger, turn * T, 0)});
    }
    scene.skin.push_back({&wall});
  } else if (kind == SceneKind::hand_deep || kind == SceneKind::palm) {
    const geometry::Mesh& mesh = hand_skin(*assets::named_hand_pose("spread")).mesh;
    const Transform T =
        kind == SceneKind::palm
            ? pressed(mesh, turn * rotation({1, 0, 0}, -std::numbers::pi / 2 + radians(between(-4, 4))),
                      between(2e-3, 20e-3))
            : pressed(mesh, turn * rotation({1, 0, 0}, radians(between(-15, 15))), between(25e-3, 45e-3));
    scene.skin.push_back({&mesh, T});
    const auto tips = assets::fingertips(*assets::named_hand_pose("spread"));
    if (kind == SceneKind::hand_deep) {
      scene.fingers.resize(5);
      for (const Vec3& p : mesh.positions) {  // whose axis is nearest
        std::size_t best = 0;
        double nearest = 1e9;
        for (std::size_t f = 0; f < 5; ++f) {
          const Vec3 from = p - tips[f].position;
          const double along = std::clamp(glm::dot(from, -tips[f].direction), 0.0, 60e-3);
          const double apart = glm::length(from + tips[f].direction * along);
          if (apart < nearest) nearest = apart, best = f;
        }
        const Vec3 world = transform_point(T, p);
        if (std::abs(world.y) < 4e-3) scene.fingers[best].push_back(world);
      }
      std::erase_if(scene.fingers, [](const auto& f) { return f.empty(); });
    } else {
      scene.fingers.push_back(some_of(mesh, T));
    }
  } else {
    const bool one = kind == SceneKind::single || kind == SceneKind::flat;
    const bool deep = kind == SceneKind::pair_deep || kind == SceneKind::five_deep;
    const int count = one ? 1 : kind == SceneKind::pair || kind == SceneKind::pair_deep ? 2 : 5;
    constexpr double tilts[] = {0, 20, 45, 65};
    const double tilt = kind == SceneKind::flat ? radians(between(80, 95)) : radians(tilts[random() % (deep ? 3 : 4)]);
    const double arc = radians(between(0, 12)), apart = between(17.6e-3, 19.5e-3),
                 depth = deep ? between(10e-3, 40e-3) : between(1e-3, 8e-3);
    for (int f = 0; f < count; ++f) {
      const double k = f - (count - 1) / 2.0, bent = arc * k;
      // Side by side along x; leaning towards z.
      Transform T = rotation({0, 1, 0}, bent) * rotation({1, 0, 0}, tilt);
      T[3] = Vec4(k * apart, 0, 4e-3 * k * k * (count > 2 ? 0.5 : 0.0), 1);
      T = pressed(finger, turn * T, std::max(1e-3, depth + between(-1e-3, 1e-3)));
      scene.skin.push_back({&finger, T});
      scene.fingers.push_back(some_of(finger, T));
    }
  }
  const std::uint64_t seed = random();
  sensing::SyntheticRig rig(scene.cameras, {}, sensing::Noise::d415, seed);
  sensing::FrameSet set;
  rig.render(scene.skin, seed, set);
  scene.images = set.frames;
  return scene;
}

Score score_of(const FingerScene& scene, const Touch& touch) {
  Score score;
  score.found = static_cast<int>(touch.finger_count);
  if (scene.fingers.empty()) return score;
  std::vector<std::uint32_t> owner;
  std::vector<int> has(scene.fingers.size());
  for (const Contact& contact : touch.contacts) {
    std::uint32_t best = 0;
    double nearest = 1e300;
    for (std::uint32_t f = 0; f < scene.fingers.size(); ++f) {
      for (const Vec3& p : scene.fingers[f]) {
        const Vec3 d = p - Vec3(contact.position);
        const double apart = glm::dot(d, d);
        if (apart < nearest) nearest = apart, best = f;
      }
    }
    owner.push_back(best);
    ++has[best];
  }
  std::vector<int> in(scene.fingers.size());
  for (std::uint32_t f = 0; f < touch.finger_count; ++f) {
    std::vector<int> share(scene.fingers.size());
    for (const std::uint32_t i : touch.fingers[f].contacts)
      ++share[owner[i]];
    int holds = 0;
    for (std::size_t g = 0; g < share.size(); ++g) {
      if (share[g] * 10 >= static_cast<int>(touch.fingers[f].contacts.size())) ++holds;
      if (share[g] > 0 && share[g] * 10 >= has[g]) ++in[g];
    }
    score.merged += holds > 1 ? 1 : 0;
  }
  for (std::size_t g = 0; g < has.size(); ++g) {
    score.fingers += has[g] >= 5 ? 1 : 0;
    score.split += in[g] > 1 ? 1 : 0;
  }
  return score;
}

}  // namespace palpa::touch::test
