// The classes of hand_rates whose hands move.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <numbers>

#include "hand_making.hpp"

namespace palpa::test::hands {
namespace {

constexpr std::array speeds{0.05, 0.1, 0.2, 0.3};

/// The height over time of skin that comes down, stays and leaves.
struct Visit {
  double high_m = 12e-3, deep_m = 3e-3;
  double comes_s = -10, down_m_s = 0.2, leaves_s = 1e9, up_m_s = 0.2;

  /// When it is as deep as it gets.
  double there_s() const { return comes_s + (high_m + deep_m) / down_m_s; }
  double height(double t) const {
    if (t > leaves_s) return std::min(high_m, up_m_s * (t - leaves_s) - deep_m);
    return std::clamp(high_m - down_m_s * (t - comes_s), -deep_m, high_m);
  }
};

/// At any time between two frames.
double some_time(const RatedHand& hand, Random& random, double from_s) {
  return from_s + random.between(0, 1 / hand.rate_hz);
}

void add_visit(RatedHand& hand, const Standing& skin, const Visit& visit, const Vec3& place = Vec3(0)) {
  hand.moves = true;
  add(hand, *skin.skin, [=](double t) { return at(place + Vec3(0, visit.height(t), 0), skin.T); });
}

void pressing(RatedHand& hand, Random& random, double lowest_deg, double highest_deg) {
  const double elevation = random.between(lowest_deg, highest_deg), azimuth = random.between(0, 360);
  hand.cameras = ring(hand.cameras.size(), elevation, azimuth, random.between(0.35, 0.45));
  hand.solids = {plate(60e-3, 50e-3)};
  hand.solids[0].haptics.press_depth_m = 3e-3;
  // Half of the fingers do not press.
  Visit visit{.deep_m = hand.seed / 3 % 2 == 0 ? random.between(4e-3, 6e-3) : random.between(1e-3, 2.2e-3)};
  visit.comes_s = some_time(hand, random, 0.12);
  visit.down_m_s = random.of(std::array{0.05, 0.1, 0.2});
  visit.leaves_s = visit.there_s() + 0.5;
  hand.length_s = visit.leaves_s + 0.15;
  const bool upright = random.coin();
  add_visit(hand, upright ? fingertip(random, 15) : pointer(random), visit);
  hand.what = fmt::format("{:.1f} mm deep, cameras {:.0f} degrees above the horizon", visit.deep_m * 1e3, elevation);
}

}  // namespace

void touch_and_leave(RatedHand& hand, Random& random) {
  hand.solids = {plate(thick_plate(random))};
  Visit visit{.deep_m = random.between(1e-3, 6e-3)};
  visit.comes_s = some_time(hand, random, 0.12);
  visit.down_m_s = random.of(speeds);
  visit.leaves_s = some_time(hand, random, visit.there_s() + 0.25);
  visit.up_m_s = random.of(speeds);
  hand.length_s = visit.leaves_s + visit.deep_m / visit.up_m_s + 0.1;
  add_visit(hand, pointer(random), visit);
  hand.what = fmt::format("down at {:.0f} mm/s, {:.1f} mm deep, up at {:.0f} mm/s", visit.down_m_s * 1e3,
                          visit.deep_m * 1e3, visit.up_m_s * 1e3);
}

void landing(RatedHand& hand, Random& random) {
  hand.solids = {plate(thick_plate(random))};
  const HandPose pose = one_of(random, std::array{named("spread"), named("relaxed"), fingers_together()}, 3);
  const HandSkin& skin = hand_skin(pose, random.coin());
  const double turn = usual_turn(random), tilt = random.between(15, 60), roll = random.between(-10, 10);
  Visit visit{.high_m = 8e-3, .deep_m = random.between(6e-3, 18e-3)};
  visit.comes_s = some_time(hand, random, 0.12);
  visit.down_m_s = random.of(speeds);
  hand.length_s = visit.there_s() + 0.3;
  add_visit(hand, {&skin, leaning(skin, {turn, tilt, roll}, usual_scale(random))}, visit);
  hand.what = fmt::format("turn {:.0f}, tilt {:.0f}, roll {:.0f}, down at {:.0f} mm/s, {:.1f} mm deep", turn, tilt,
                          roll, visit.down_m_s * 1e3, visit.deep_m * 1e3);
}

void second_finger(RatedHand& hand, Random& random) {
  hand.solids = {plate(thick_plate(random))};
  const double apart = random.between(19e-3, 32e-3), thick = random.between(15e-3, 19e-3),
               turn = random.between(0, 360), tilt = random.between(0, 55);
  const Transform turns = turned({0, 1, 0}, turn);
  const Standing finger{&finger_skin(),
                        standing(finger_skin(), turns * turned({1, 0, 0}, tilt) * scaled(thick / 18e-3), 2e-3)};
  const Vec3 aside = transform_direction(turns, {apart / 2, 0, 0});
  const Visit rests{.deep_m = random.between(1e-3, 5e-3)};
  Visit comes{.deep_m = random.between(1e-3, 5e-3)};
  comes.comes_s = some_time(hand, random, 0.12);
  comes.down_m_s = random.of(speeds);
  hand.length_s = comes.there_s() + 0.35;
  add_visit(hand, finger, rests, -aside);
  add_visit(hand, finger, comes, aside);
  hand.what = fmt::format("{:.1f} mm apart, {:.1f} mm thick, down at {:.0f} mm/s, {:.1f} mm deep beside {:.1f} mm",
                          apart * 1e3, thick * 1e3, comes.down_m_s * 1e3, comes.deep_m * 1e3, rests.deep_m * 1e3);
}

void pinch(RatedHand& hand, Random& random) {
  hand.solids = {plate(thick_plate(random))};
  const bool left = random.coin();
  const HandPose pose = pinching();
  const HandSkin& skin = hand_skin(pose, left);
  const auto tips = assets::fingertips(pose);
  Vec3 across = tips[1].position - tips[0].position, down = tips[0].direction + tips[1].direction;
  if (left) across.x = -across.x, down.x = -down.x;
  across = glm::normalize(across);
  down = glm::normalize(down - across * glm::dot(down, across));
  // The tips next to each other along x, and the thumb at most as high.
  const Transform T_pinch_skin =
      glm::transpose(Transform(Vec4(across, 0), Vec4(-down, 0), Vec4(glm::cross(across, -down), 0), Vec4(0, 0, 0, 1)));
  const double turn = random.between(0, 360), lean = random.between(-15, 15), low = random.between(0, 9);
  const Transform T_world_pinch = turned({0, 1, 0}, turn) * turned({1, 0, 0}, lean) * turned({0, 0, 1}, low);
  add(hand, skin, standing(skin, T_world_pinch * T_pinch_skin * scaled(usual_scale(random)), 2e-3));
  hand.what = fmt::format("the thumb is lower by {:.0f} degrees", low);
  if (hand.seed % 2 == 1) {  // from farther away, as many contacts are a larger patch
    const double elevation = random.between(-55, -20), azimuth = random.between(0, 360);
    hand.cameras = ring(hand.cameras.size(), elevation, azimuth, random.between(0.5, 0.65));
    hand.what += ", far cameras";
  }
  press_to(hand, 44, 10e-3, [](const TrueFrame& frame) { return frame.contacts[1]; });
  Visit visit{.deep_m = 0, .comes_s = some_time(hand, random, 0.12)};
  visit.down_m_s = random.of(std::array{0.05, 0.1, 0.2});
  hand.moves = true;
  hand.bodies[0].pose = [=, deep = hand.bodies[0].pose](double t) { return at({0, visit.height(t), 0}, deep(t)); };
  hand.length_s = visit.there_s() + 0.5;
}

void taps(RatedHand& hand, Random& random) {
  hand.solids = {plate(thick_plate(random))};
  const double hz = random.between(4, 8), deep = random.between(1e-3, 5e-3), high = random.between(3e-3, 10e-3),
               begins_s = some_time(hand, random, 0.15);
  const Standing skin = pointer(random);
  hand.moves = true;
  add(hand, *skin.skin, [=](double t) {
    const double turns = std::clamp((t - begins_s) * hz, 0.0, 2.0);
    return at({0, (high - deep) / 2 + (high + deep) / 2 * std::cos(2 * std::numbers::pi * turns), 0}, skin.T);
  });
  hand.length_s = begins_s + 2 / hz + 0.15;
  hand.what = fmt::format("{:.1f} Hz, {:.1f} mm deep, {:.1f} mm high", hz, deep * 1e3, high * 1e3);
}

void leave(RatedHand& hand, Random& random) {
  hand.solids = {plate(thick_plate(random))};
  hand.rate_hz = hand.seed / 9 % 2 == 1 ? 30 : 90;
  Visit visit{.high_m = 20e-3, .deep_m = random.of(std::array{1e-3, 2e-3, 4e-3})};
  visit.up_m_s = std::array{0.02, 0.1, 0.3}[hand.seed / 3 % 3];
  visit.leaves_s = some_time(hand, random, 0.2);
  hand.length_s = visit.leaves_s + visit.deep_m / visit.up_m_s + 0.15;
  add_visit(hand, pointer(random), visit);
  hand.what = fmt::format("from {:.0f} mm up at {:.0f} mm/s", visit.deep_m * 1e3, visit.up_m_s * 1e3);
}

void slide(RatedHand& hand, Random& random) {
  hand.solids = {plate(thick_plate(random))};
  const double speed = random.of(speeds), deep = random.between(2e-3, 6e-3);
  hand.length_s = std::min(hand.length_s, 0.11 / speed);
  const Vec3 way = transform_direction(turned({0, 1, 0}, random.between(0, 360)), {speed, 0, 0});
  Standing skin = pointer(random);
  const char* what = "a finger";
  if (random.below(3) == 0) {
    const HandPose pose = random.coin() ? named("relaxed") : two_straight();
    const HandSkin& whole = hand_skin(pose, random.coin());
    const double turn = usual_turn(random);
    skin = {&whole, leaning(whole, {turn, random.between(15, 50), 0}, 1)};
    what = "a hand";
  }
  hand.moves = true;
  add(hand, *skin.skin,
      [=, half_s = hand.length_s / 2](double t) { return at(way * (t - half_s) - Vec3(0, deep, 0), skin.T); });
  hand.what = fmt::format("{} at {:.0f} mm/s, {:.1f} mm deep", what, speed * 1e3, deep * 1e3);
}

void faint(RatedHand& hand, Random& random) {
  hand.solids = {plate(60e-3)};
  hand.length_s = 0.55;
  const double deep = random.between(0, 0.2e-3);
  const Vec3 way = transform_direction(turned({0, 1, 0}, random.between(0, 360)), {0.2, 0, 0});
  hand.moves = true;
  add(hand, finger_skin(),
      [=, T = fingertip(random).T](double t) { return at(way * (t - 0.275) - Vec3(0, deep, 0), T); });
  hand.what = fmt::format("200 mm/s, {:.2f} mm deep", deep * 1e3);
}

void turning(RatedHand& hand, Random& random) {
  hand.solids = {plate(thick_plate(random))};
  const double deep = random.between(2e-3, 5e-3);
  // About the vertical through the tip, or about a horizontal line 8 mm above it, as a finger that rolls.
  const bool rolls = random.coin();
  Standing skin = rolls ? fingertip(random) : pointer(random);
  if (!rolls && random.below(3) == 0) {
    const HandPose pose = two_straight();
    const HandSkin& two = hand_skin(pose, random.coin());
    const double turn = usual_turn(random);
    skin = {&two, leaning(two, {turn, random.between(15, 45), 0}, 1)};
  }
  const Vec3 axis = rolls ? transform_direction(turned({0, 1, 0}, random.between(0, 360)), {1, 0, 0}) : Vec3(0, 1, 0);
  const double rate_deg = random.of(std::array{60.0, 120.0, 180.0}), swing_deg = rolls ? 15 : 40;
  hand.moves = true;
  add(hand, *skin.skin, [=](double t) {
    const double angle = swing_deg * std::sin(rate_deg / swing_deg * t);
    const Vec3 pivot(0, 8e-3, 0);
    return at({0, -deep, 0}, at(pivot, turned(axis, angle) * at(-pivot, skin.T)));
  });
  hand.what = fmt::format("{} by {:.0f} degrees, at most {:.0f} degrees/s, {:.1f} mm deep", rolls ? "rolls" : "turns",
                          swing_deg, rate_deg, deep * 1e3);
}

void meeting(RatedHand& hand, Random& random) {
  hand.solids = {plate(thick_plate(random))};
  const double thick = 18e-3, far = 38e-3, speed = random.of(std::array{0.05, 0.1, 0.2}),
               aside = random.of(std::array{14e-3, 19e-3});
  const bool crosses = random.coin();
  const Transform turns = turned({0, 1, 0}, random.between(0, 360));
  const Transform T = standing(finger_skin(), turns, 2e-3);
  hand.moves = true;
  for (const double side : {-0.5, 0.5}) {
    add(hand, finger_skin(), [=](double t) {
      const double gone = 2 * speed * t;  // both move
      const Vec3 apart = crosses ? Vec3(far - gone, 0, aside) : Vec3(thick + std::abs(far - thick - gone), 0, 0);
      return at(transform_direction(turns, side * apart) - Vec3(0, 3e-3, 0), T);
    });
  }
  hand.length_s = (crosses ? far : far - thick) / speed;
  hand.what = fmt::format("{} at {:.0f} mm/s each", crosses ? "cross" : "meet and part", speed * 1e3);
}

void above(RatedHand& hand, Random& random) {
  pressing(hand, random, 15, 40);
}
void beside(RatedHand& hand, Random& random) {
  pressing(hand, random, -10, 10);
}
void below(RatedHand& hand, Random& random) {
  pressing(hand, random, -55, -25);
}

}  // namespace palpa::test::hands
