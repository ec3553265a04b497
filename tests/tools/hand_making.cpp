#include "hand_making.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <glm/geometric.hpp>
#include <utility>

#include "touch/fingertips.hpp"
#include "touch/harness.hpp"

namespace palpa::test::hands {

HandPose named(const char* name) {
  return *assets::named_hand_pose(name);
}
HandPose fingers_together() {
  return {{0.10, 0.10, 0.10, -0.10},
          {{{0.12, 0.15, 0.10, -0.06}, {0.10, 0.15, 0.10, 0.0}, {0.12, 0.15, 0.10, -0.05}, {0.15, 0.18, 0.10, -0.10}}}};
}
HandPose pinching() {
  return {{0.60, 0.10, 0.60, -0.10},
          {{{0.90, 0.60, 0.40, 0.00}, {1.25, 1.60, 1.05, 0.00}, {1.30, 1.65, 1.05, 0.00}, {1.30, 1.60, 1.05, 0.02}}}};
}
HandPose ring_of_two() {
  return {{0.60, 0.10, 0.60, -0.10},
          {{{0.90, 0.60, 0.40, 0.00}, {0.45, 0.35, 0.20, 0.03}, {0.35, 0.30, 0.20, 0.12}, {0.30, 0.30, 0.20, 0.30}}}};
}
HandPose two_straight() {
  return {{0.70, 0.20, 0.70, -0.25},
          {{{0.05, 0.05, 0.05, 0.16}, {0.05, 0.05, 0.05, -0.10}, {1.30, 1.70, 1.05, 0.00}, {1.30, 1.65, 1.05, 0.02}}}};
}
HandPose three_straight() {
  return {{-0.05, 0.10, 0.10, 0.05},
          {{{0.10, 0.10, 0.05, 0.14}, {0.10, 0.10, 0.05, -0.02}, {1.30, 1.70, 1.05, 0.00}, {1.30, 1.65, 1.05, 0.02}}}};
}
HandPose claw() {
  return {{0.25, 0.30, 0.50, 0.20},
          {{{0.20, 0.95, 0.55, 0.14}, {0.22, 1.00, 0.55, 0.02}, {0.24, 1.00, 0.55, 0.12}, {0.26, 0.95, 0.55, 0.28}}}};
}

HandPose varied(HandPose pose, std::size_t who) {
  const double bends = std::array{1.0, 0.85, 1.12}[who], spreads = std::array{1.0, 1.1, 0.9}[who];
  pose.thumb.cmc *= bends, pose.thumb.mcp *= bends, pose.thumb.ip *= bends;
  for (assets::FingerPose& finger : pose.fingers)
    finger.mcp *= bends, finger.pip *= bends, finger.dip *= bends, finger.abduction *= spreads;
  return pose;
}

geometry::Solid plate(double thick_m, double half_m) {
  return touch::test::box({-half_m, -thick_m, -half_m}, {half_m, 0, half_m}, "plate");
}

double thick_plate(Random& random) {
  return random.of(std::array{35e-3, 60e-3});
}

std::vector<sensing::Camera> ring(std::size_t count, double elevation_deg, double azimuth_deg, double distance_m) {
  std::vector<sensing::Camera> cameras =
      touch::test::ring_of_cameras(static_cast<int>(count), elevation_deg, azimuth_deg);
  for (sensing::Camera& camera : cameras) {
    Vec4& eye = camera.T_world_camera[3];
    eye = Vec4(glm::normalize(Vec3(eye)) * distance_m, 1);
  }
  return cameras;
}

RatedHand begun(std::uint64_t seed, int cameras) {
  RatedHand hand;
  hand.seed = seed;
  hand.cameras = touch::test::paper_cameras(cameras);
  hand.rate_hz = seed / 3 % 3 == 2 ? 30 : 90;
  hand.length_s = hand.rate_hz < 60 ? 0.8 : 0.5;
  return hand;
}

Transform at(const Vec3& place, Transform T) {
  T[3] += Vec4(place, 0);
  return T;
}

Transform scaled(double factor) {
  return Transform(Vec4(factor, 0, 0, 0), Vec4(0, factor, 0, 0), Vec4(0, 0, factor, 0), Vec4(0, 0, 0, 1));
}

Transform standing(const HandSkin& skin, Transform T, double deep_m) {
  T = pressed(skin.mesh, T, 0);
  Vec3 sum(0);
  double count = 0;
  for (const Vec3& p : skin.mesh.positions) {
    const Vec3 world = transform_point(T, p);
    if (world.y < deep_m) sum += world, ++count;
  }
  T[3] -= Vec4(sum.x / count, 0, sum.z / count, 0);
  return T;
}

Transform leaning(const HandSkin& skin, const Lean& lean, double scale) {
  return standing(skin, turned({0, 1, 0}, 180 + lean.turn_deg) * turned({1, 0, 0}, -lean.tilt_deg) *
                            turned({0, 1, 0}, lean.roll_deg) * scaled(scale));
}

double usual_turn(Random& random) {
  return random.between(-60, 60);
}
double usual_scale(Random& random) {
  return random.between(0.88, 1.08);
}

Standing fingertip(Random& random, double tilt_most_deg, double thick_m) {
  if (thick_m == 0) thick_m = random.between(14e-3, 20e-3);
  const Transform turn = turned({0, 1, 0}, random.between(0, 360));
  const Transform tilt = turned({1, 0, 0}, random.between(0, tilt_most_deg));
  return {&finger_skin(), standing(finger_skin(), turn * tilt * scaled(thick_m / 18e-3), 2e-3)};
}

Standing pointing(Random& random) {
  const HandPose pose = named("point");
  const HandSkin& skin = hand_skin(pose, random.coin());
  const double turn = usual_turn(random), tilt = random.between(10, 60), roll = random.between(-20, 20);
  return {&skin, leaning(skin, {turn, tilt, roll}, usual_scale(random))};
}

Standing pointer(Random& random) {
  return random.coin() ? pointing(random) : fingertip(random);
}

void add(RatedHand& hand, const HandSkin& skin, sensing::Motion pose) {
  const std::uint32_t first = hand.parts();
  hand.bodies.push_back({&skin, first, std::move(pose)});
}
void add(RatedHand& hand, const HandSkin& skin, const Transform& T) {
  add(hand, skin, [T](double) { return T; });
}

void add_row(RatedHand& hand, std::size_t count, double thick_m, double apart_m, double turn_deg, double tilt_deg,
             const std::function<double()>& deep_m) {
  const Transform turn = turned({0, 1, 0}, turn_deg);
  const Transform T = standing(finger_skin(), turn * turned({1, 0, 0}, tilt_deg) * scaled(thick_m / 18e-3), 2e-3);
  for (std::size_t f = 0; f < count; ++f) {
    const double along = (static_cast<double>(f) - 0.5 * static_cast<double>(count - 1)) * apart_m;
    add(hand, finger_skin(), at(transform_direction(turn, {along, 0, 0}) - Vec3(0, deep_m(), 0), T));
  }
}

void press_to(RatedHand& hand, int contacts, double deepest_m,
              const std::function<int(const TrueFrame&)>& contacts_of) {
  const std::vector<HandBody> before = hand.bodies;
  double low = 0, high = deepest_m;
  const auto press = [&](double deep) {
    for (std::size_t b = 0; b < before.size(); ++b)
      hand.bodies[b].pose = [=, pose = before[b].pose](double t) { return at({0, -deep, 0}, pose(t)); };
  };
  for (int n = 0; n < 9; ++n) {
    const double middle = (low + high) / 2;
    press(middle);
    HandTruth truth(hand);
    (contacts_of(truth.at(0)) < contacts ? low : high) = middle;
  }
  press(high);
  hand.what += fmt::format(", {:.2f} mm deep", high * 1e3);
}

}  // namespace palpa::test::hands
