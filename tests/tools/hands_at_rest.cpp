// The classes of hand_rates whose hands do not move.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "hand_making.hpp"

namespace palpa::test::hands {
namespace {

/// A hand on a plate.
void resting(RatedHand& hand, Random& random, const HandPose& pose, const Lean& lean, double press_m, double plate_m) {
  hand.solids = {plate(plate_m)};
  const bool left = random.coin();
  const HandSkin& skin = hand_skin(pose, left);
  add(hand, skin, at({0, -press_m, 0}, leaning(skin, lean, usual_scale(random))));
  hand.what =
      fmt::format("{} hand, turn {:.0f}, tilt {:.0f}, roll {:.0f}, {:.1f} mm deep, plate {:.0f} mm",
                  left ? "left" : "right", lean.turn_deg, lean.tilt_deg, lean.roll_deg, press_m * 1e3, plate_m * 1e3);
}

void on_thick_plate(RatedHand& hand, Random& random, const HandPose& pose, const Lean& lean, double least_m,
                    double most_m) {
  const double press_m = random.between(least_m, most_m);
  resting(hand, random, pose, lean, press_m, thick_plate(random));
}

Lean lean_of(Random& random, double tilt_least_deg, double tilt_most_deg, double roll_deg = 10) {
  const double turn = usual_turn(random), tilt = random.between(tilt_least_deg, tilt_most_deg);
  return {turn, tilt, random.between(-roll_deg, roll_deg)};
}

}  // namespace

void fist(RatedHand& hand, Random& random) {
  const HandPose pose = varied(named("fist"), random.below(2));
  on_thick_plate(hand, random, pose, lean_of(random, 0, 45, 15), 3e-3, 8e-3);
}

void spread(RatedHand& hand, Random& random) {
  const HandPose pose = varied(named("spread"), random.below(3));
  on_thick_plate(hand, random, pose, lean_of(random, 15, 55), 8e-3, 25e-3);
}

void flat(RatedHand& hand, Random& random) {
  const HandPose pose = random.coin() ? varied(named("spread"), random.below(3)) : fingers_together();
  on_thick_plate(hand, random, pose, lean_of(random, 84, 96, 5), 3e-3, 15e-3);
}

void palm(RatedHand& hand, Random& random) {
  HandPose pose = random.coin() ? varied(named("spread"), random.below(3)) : fingers_together();
  pose.thumb.abduction = -0.5;  // in the plane of the palm
  on_thick_plate(hand, random, pose, lean_of(random, 86, 96, 5), 3e-3, 14e-3);
}

void touching(RatedHand& hand, Random& random) {
  if (random.coin()) {
    const HandPose pose = varied(fingers_together(), random.below(3));
    on_thick_plate(hand, random, pose, lean_of(random, 15, 55), 6e-3, 25e-3);
    return;
  }
  hand.solids = {plate(thick_plate(random))};
  const std::size_t count = 2 + random.below(3);
  const double thick = random.between(14e-3, 18e-3), turn = random.between(0, 360), tilt = random.between(0, 60),
               deep = random.between(1.5e-3, 12e-3);
  add_row(hand, count, thick, thick, turn, tilt, [&] { return deep + random.between(-0.5e-3, 0.5e-3); });
  hand.what = fmt::format("{} fingers of {:.1f} mm, tilt {:.0f}, {:.1f} mm deep", count, thick * 1e3, tilt, deep * 1e3);
}

void relaxed(RatedHand& hand, Random& random) {
  const HandPose pose = varied(named("relaxed"), random.below(3));
  on_thick_plate(hand, random, pose, lean_of(random, 10, 55), 6e-3, 22e-3);
}

void leans(RatedHand& hand, Random& random) {
  const HandPose pose = one_of(random, std::array{named("spread"), named("relaxed"), fingers_together()}, 3);
  on_thick_plate(hand, random, pose, lean_of(random, 55, 80, 30), 6e-3, 25e-3);
}

void leans_away(RatedHand& hand, Random& random) {
  const HandPose pose = one_of(random, std::array{named("spread"), named("relaxed"), fingers_together()}, 3);
  const Lean lean = lean_of(random, 50, 75);
  // The first camera is where the fingers point to, and looks nearly along their skin.
  const double elevation = lean.tilt_deg - 90 + random.between(-25, 25), aside = random.between(-45, 45);
  hand.cameras = ring(hand.cameras.size(), elevation, -90 - lean.turn_deg + aside, random.between(0.33, 0.5));
  on_thick_plate(hand, random, pose, lean, 12e-3, 20e-3);
  hand.what += fmt::format(", first camera {:.0f} degrees beside, {:.0f} above the horizon", aside, elevation);
}

void odd(RatedHand& hand, Random& random) {
  const HandPose pose =
      random.of(std::array{pinching(), ring_of_two(), two_straight(), three_straight(), claw(), named("point")});
  Lean lean = lean_of(random, -40, 80, 45);
  lean.turn_deg = random.between(0, 360);
  on_thick_plate(hand, random, pose, lean, 4e-3, 25e-3);
}

void two_people(RatedHand& hand, Random& random) {
  hand.solids = {plate(thick_plate(random))};
  const double apart = random.between(35e-3, 80e-3);
  for (const double side : {1.0, -1.0}) {
    const HandPose pose = random.of(std::array{named("relaxed"), named("spread"), named("point"), named("fist")});
    const HandSkin& skin = hand_skin(pose, random.coin());
    Lean lean = lean_of(random, 15, 50);
    lean.turn_deg = lean.turn_deg / 2 + (side > 0 ? 0 : 180);
    const double deep = random.between(4e-3, 15e-3), aside = random.between(-20e-3, 20e-3);
    // The tips face each other.
    const Transform T = leaning(skin, lean, usual_scale(random));
    double foremost = -1;
    for (const Vec3& p : skin.mesh.positions) {
      const Vec3 world = transform_point(T, p);
      if (world.y < deep) foremost = std::max(foremost, -side * world.z);
    }
    add(hand, skin, at({aside, -deep, side * (foremost + apart / 2)}, T));
  }
  hand.what = fmt::format("{:.0f} mm apart", apart * 1e3);
}

void thin(RatedHand& hand, Random& random) {
  const std::array poses{named("spread"), named("relaxed"), fingers_together(), named("fist")};
  const HandPose pose = one_of(random, poses, 2);
  const double tilt = random.of(std::array{20.0, 45.0, 65.0, 88.0});
  const Lean lean = lean_of(random, tilt - 5, tilt + 5);
  resting(hand, random, pose, lean, random.between(1e-3, 12e-3), 2e-3);
}

void through(RatedHand& hand, Random& random) {
  const HandPose pose = random.of(std::array{named("spread"), named("relaxed"), named("point"), two_straight()});
  const Lean lean = lean_of(random, 5, 50);
  const double thick = random.between(6e-3, 15e-3);
  resting(hand, random, pose, lean, thick + random.between(3e-3, 12e-3), thick);
}

void back(RatedHand& hand, Random& random) {
  const HandPose pose = varied(random.coin() ? named("spread") : named("relaxed"), random.below(3));
  const Lean lean = lean_of(random, -100, -80, 8);
  const double deep = random.between(2e-3, 10e-3);
  resting(hand, random, pose, lean, deep, random.below(3) > 0 ? 2e-3 : 35e-3);
}

void rims(RatedHand& hand, Random& random) {
  const std::array poses{named("spread"), named("relaxed"), fingers_together(), named("point")};
  const HandPose pose = one_of(random, poses, 2);
  const Lean lean = lean_of(random, 15, 70);
  resting(hand, random, pose, lean, random.between(2e-3, 12e-3), 40e-3);
  // The middle of the touch is on an edge of a small box.
  const double half = random.between(20e-3, 40e-3), thick = random.of(std::array{3e-3, 25e-3, 40e-3});
  const Vec3 way = transform_direction(turned({0, 1, 0}, random.between(0, 360)), {0, 0, 1});
  const double far = half / std::max(std::abs(way.x), std::abs(way.z));
  hand.solids = {plate(thick, half)};
  hand.bodies[0].pose = [T = at(way * far, hand.bodies[0].pose(0))](double) { return T; };
  hand.what += fmt::format(", at the edge of a box of {:.0f} x {:.0f} mm", 2e3 * half, thick * 1e3);
}

void sparse(RatedHand& hand, Random& random) {
  hand.solids = {plate(35e-3)};
  const double thick = random.between(14e-3, 17e-3), apart = thick + random.between(0, 1e-3),
               turn = random.between(0, 360), tilt = random.between(0, 45), elevation = random.between(-45, -10),
               azimuth = (random.coin() ? 90 : 270) - turn + random.between(-70, 70);
  const int wanted = 24 + static_cast<int>(random.below(9));
  hand.what = fmt::format("fingers of {:.1f} mm, {} contacts each, tilt {:.0f}", thick * 1e3, wanted, tilt);
  const auto contacts_of = [](const TrueFrame& frame) {
    return frame.contacts[0] + frame.contacts[1] + frame.contacts[2];
  };
  if (hand.seed % 3 == 0) {  // tips that graze the surface
    hand.cameras = ring(1, elevation, azimuth, random.between(0.5, 0.6));
    add_row(hand, 3, thick, apart, turn, tilt, [] { return 0; });
    press_to(hand, 3 * wanted, 4e-3, contacts_of);
    return;
  }
  // Fingers that reach through it, seen from so far away that a row of pixels is left of each.
  const double deep = random.between(5e-3, 14e-3);
  add_row(hand, 3, thick, apart, turn, tilt, [&] { return deep + random.between(-0.5e-3, 0.5e-3); });
  double near = 0.35, far = 1;
  for (int n = 0; n < 9; ++n) {
    const double middle = (near + far) / 2;
    hand.cameras = ring(1, elevation, azimuth, middle);
    HandTruth truth(hand);
    (contacts_of(truth.at(0)) > 3 * wanted ? near : far) = middle;
  }
  hand.what += fmt::format(", {:.1f} mm deep, camera at {:.2f} m", deep * 1e3, far);
}

void hover(RatedHand& hand, Random& random) {
  hand.solids = {plate(thick_plate(random))};
  hand.length_s = 2;
  const double above = random.between(0.1e-3, 0.2e-3);
  const Standing skin = pointer(random);
  add(hand, *skin.skin, at({0, above, 0}, skin.T));
  hand.what = fmt::format("{:.2f} mm above", above * 1e3);
}

}  // namespace palpa::test::hands
