#include "hand_classes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <numbers>
#include <random>
#include <utility>

#include "base/error.hpp"
#include "geometry/gltf/gltf.hpp"
#include "hand_truth.hpp"
#include "sensing/recording.hpp"
#include "support/shared_data.hpp"
#include "touch/fingertips.hpp"
#include "touch/harness.hpp"

namespace palpa::test {
namespace {

using assets::HandPose;

/// The same numbers from every standard library.
class Random {
 public:
  explicit Random(std::uint64_t seed) : bits_(seed) {}
  double between(double low, double high) {
    return low + (high - low) * static_cast<double>(bits_() >> 11) * 0x1p-53;
  }
  std::size_t below(std::size_t count) { return static_cast<std::size_t>(bits_() % count); }
  template <std::size_t N>
  double of(const std::array<double, N>& values) {
    return values[below(N)];
  }

 private:
  std::mt19937_64 bits_;
};

// ---- poses ----------------------------------------------------------------------------------------------------------

HandPose named(const char* name) {
  return *assets::named_hand_pose(name);
}
const HandPose together{{0.10, 0.10, 0.10, -0.10},
                        {{{0.12, 0.15, 0.10, -0.06},
                          {0.10, 0.15, 0.10, 0.00},
                          {0.12, 0.15, 0.10, -0.05},
                          {0.15, 0.18, 0.10, -0.10}}}};
/// The tips of thumb and index finger are 2 mm apart.
const HandPose pinching{{0.60, 0.10, 0.60, -0.10},
                        {{{0.90, 0.60, 0.40, 0.00},
                          {1.25, 1.60, 1.05, 0.00},
                          {1.30, 1.65, 1.05, 0.00},
                          {1.30, 1.60, 1.05, 0.02}}}};
const HandPose ring_of_two{{0.60, 0.10, 0.60, -0.10},
                           {{{0.90, 0.60, 0.40, 0.00},
                             {0.45, 0.35, 0.20, 0.03},
                             {0.35, 0.30, 0.20, 0.12},
                             {0.30, 0.30, 0.20, 0.30}}}};
const HandPose two_straight{{0.70, 0.20, 0.70, -0.25},
                            {{{0.05, 0.05, 0.05, 0.16},
                              {0.05, 0.05, 0.05, -0.10},
                              {1.30, 1.70, 1.05, 0.00},
                              {1.30, 1.65, 1.05, 0.02}}}};
const HandPose three_straight{{-0.05, 0.10, 0.10, 0.05},
                              {{{0.10, 0.10, 0.05, 0.14},
                                {0.10, 0.10, 0.05, -0.02},
                                {1.30, 1.70, 1.05, 0.00},
                                {1.30, 1.65, 1.05, 0.02}}}};
const HandPose claw{{0.25, 0.30, 0.50, 0.20},
                    {{{0.20, 0.95, 0.55, 0.14},
                      {0.22, 1.00, 0.55, 0.02},
                      {0.24, 1.00, 0.55, 0.12},
                      {0.26, 0.95, 0.55, 0.28}}}};

/// One of three people's: their joints bend differently.
HandPose varied(HandPose pose, std::size_t who) {
  const double bends = std::array{1.0, 0.85, 1.12}[who], spreads = std::array{1.0, 1.1, 0.9}[who];
  pose.thumb.cmc *= bends, pose.thumb.mcp *= bends, pose.thumb.ip *= bends;
  for (assets::FingerPose& finger : pose.fingers)
    finger.mcp *= bends, finger.pip *= bends, finger.dip *= bends, finger.abduction *= spreads;
  return pose;
}

// ---- solids and cameras ---------------------------------------------------------------------------------------------

/// Its top is at y = 0.
geometry::Solid plate(double thick_m, double half_m = 0.3) {
  return touch::test::box({-half_m, -thick_m, -half_m}, {half_m, 0, half_m}, "plate");
}

std::vector<sensing::Camera> ring(int count, double elevation_deg, double azimuth_deg, double distance_m) {
  std::vector<sensing::Camera> cameras = touch::test::ring_of_cameras(count, elevation_deg, azimuth_deg);
  for (sensing::Camera& camera : cameras) {
    Vec4& eye = camera.T_world_camera[3];
    eye = Vec4(glm::normalize(Vec3(eye)) * distance_m, 1);
  }
  return cameras;
}

/// One to three cameras of the paper's rig, 30 or 90 Hz.
RatedHand begun(const char* kind, std::uint64_t seed) {
  RatedHand hand{.kind = kind, .seed = seed};
  hand.cameras = touch::test::paper_cameras(1 + static_cast<int>(seed % 3));
  hand.rate_hz = seed / 3 % 3 == 2 ? 30 : 90;
  hand.length_s = hand.rate_hz < 60 ? 0.8 : 0.5;
  return hand;
}

// ---- skin -----------------------------------------------------------------------------------------------------------

/// Skin whose lowest place is at y = 0, moved so that what is lowest is near the origin.
Transform standing(const HandSkin& skin, Transform T, double deep_m = 10e-3) {
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

Transform at(const Vec3& place, Transform T) {
  T[3] += Vec4(place, 0);
  return T;
}

Transform scaled(double factor) {
  return Transform(Vec4(factor, 0, 0, 0), Vec4(0, factor, 0, 0), Vec4(0, 0, factor, 0), Vec4(0, 0, 0, 1));
}

struct Lean {
  double turn_deg = 0;  ///< about the vertical; 0: the hand comes from +z
  double tilt_deg = 0;  ///< towards the palm; 90: it lies on its palm, -90: on its back
  double roll_deg = 0;  ///< about its own length
};

Transform leaning(const HandSkin& skin, const Lean& lean, double scale) {
  return standing(skin, turned({0, 1, 0}, 180 + lean.turn_deg) * turned({1, 0, 0}, -lean.tilt_deg) *
                            turned({0, 1, 0}, lean.roll_deg) * scaled(scale));
}

void add(RatedHand& hand, const HandSkin& skin, sensing::Motion pose) {
  const std::uint32_t first = hand.parts();
  hand.bodies.push_back({&skin, first, std::move(pose)});
}
void add(RatedHand& hand, const HandSkin& skin, const Transform& T) {
  add(hand, skin, [T](double) { return T; });
}

/// A hand at rest in front of the paper's rig.
RatedHand resting(const char* kind, std::uint64_t seed, const HandPose& pose, Random& random, const Lean& lean,
                  double press_m, double plate_m) {
  RatedHand hand = begun(kind, seed);
  hand.solids = {plate(plate_m)};
  const HandSkin& skin = hand_skin(pose, random.below(2) == 1);
  add(hand, skin, at({0, -press_m, 0}, leaning(skin, lean, random.between(0.88, 1.08))));
  hand.what = fmt::format("turn {:.0f}, tilt {:.0f}, roll {:.0f}, {:.1f} mm deep, plate {:.0f} mm", lean.turn_deg,
                          lean.tilt_deg, lean.roll_deg, press_m * 1e3, plate_m * 1e3);
  return hand;
}

/// A fingertip, 14 to 20 mm thick unless it is given, that leans.
Transform fingertip(Random& random, double tilt_most_deg = 60, double thick_m = 0) {
  if (thick_m == 0) thick_m = random.between(14e-3, 20e-3);
  const double turn = random.between(0, 360), tilt = random.between(0, tilt_most_deg);
  return standing(finger_skin(),
                  turned({0, 1, 0}, turn) * turned({1, 0, 0}, tilt) * scaled(thick_m / 18e-3), 2e-3);
}

struct Skin {
  const HandSkin* skin;
  Transform T;  ///< its lowest place is at y = 0
};
/// A fingertip, or a hand whose index finger points.
Skin pointer(Random& random) {
  if (random.below(2) == 0) return {&finger_skin(), fingertip(random)};
  const HandSkin& skin = hand_skin(named("point"), random.below(2) == 1);
  return {&skin, leaning(skin, {random.between(-60, 60), random.between(10, 60), random.between(-20, 20)},
                         random.between(0.88, 1.08))};
}

double plate_of(Random& random) {
  return random.of(std::array{20e-3, 35e-3, 60e-3});
}
double usual_turn(Random& random) {
  return random.between(-60, 60);
}

// ---- hands at rest --------------------------------------------------------------------------------------------------

RatedHand fist(std::uint64_t seed) {
  Random random(seed);
  const Lean lean{usual_turn(random), random.between(0, 45), random.between(-15, 15)};
  return resting("fist", seed, varied(named("fist"), random.below(2)), random, lean, random.between(3e-3, 8e-3),
                 plate_of(random));
}
RatedHand spread(std::uint64_t seed) {
  Random random(seed);
  const Lean lean{usual_turn(random), random.between(15, 55), random.between(-10, 10)};
  return resting("spread", seed, varied(named("spread"), random.below(3)), random, lean, random.between(8e-3, 25e-3),
                 plate_of(random));
}
RatedHand flat(std::uint64_t seed) {
  Random random(seed);
  const Lean lean{usual_turn(random), random.between(84, 96), random.between(-5, 5)};
  return resting("flat", seed, random.below(2) ? varied(named("spread"), random.below(3)) : together, random, lean,
                 random.between(3e-3, 15e-3), plate_of(random));
}
RatedHand touching(std::uint64_t seed) {
  Random random(seed);
  if (random.below(2) == 0) {
    const Lean lean{usual_turn(random), random.between(15, 55), random.between(-10, 10)};
    return resting("touching", seed, varied(together, random.below(3)), random, lean, random.between(6e-3, 25e-3),
                   plate_of(random));
  }
  RatedHand hand = begun("touching", seed);
  hand.solids = {plate(plate_of(random))};
  const std::size_t count = 2 + random.below(3);
  const double thick = random.between(14e-3, 18e-3), turn = random.between(0, 360), tilt = random.between(0, 60),
               deep = random.between(1.5e-3, 12e-3);
  for (std::size_t f = 0; f < count; ++f) {
    const double place = (static_cast<double>(f) - 0.5 * static_cast<double>(count - 1)) * thick;
    const Transform turns = turned({0, 1, 0}, turn);
    add(hand, finger_skin(),
        at(transform_direction(turns, {place, 0, 0}) - Vec3(0, deep + random.between(-0.5e-3, 0.5e-3), 0),
           standing(finger_skin(), turns * turned({1, 0, 0}, tilt) * scaled(thick / 18e-3), 2e-3)));
  }
  hand.what = fmt::format("{} fingers of {:.1f} mm, tilt {:.0f}, {:.1f} mm deep", count, thick * 1e3, tilt, deep * 1e3);
  return hand;
}
RatedHand relaxed(std::uint64_t seed) {
  Random random(seed);
  const Lean lean{usual_turn(random), random.between(10, 55), random.between(-10, 10)};
  return resting("relaxed", seed, varied(named("relaxed"), random.below(3)), random, lean,
                 random.between(6e-3, 22e-3), plate_of(random));
}
RatedHand leans(std::uint64_t seed) {
  Random random(seed);
  const std::array poses{named("spread"), named("relaxed"), together};
  const Lean lean{usual_turn(random), random.between(55, 80), random.between(-30, 30)};
  const HandPose pose = varied(poses[random.below(3)], random.below(3));
  return resting("leaning", seed, pose, random, lean, random.between(6e-3, 25e-3), plate_of(random));
}
RatedHand odd(std::uint64_t seed) {
  Random random(seed);
  const std::array poses{pinching, ring_of_two, two_straight, three_straight, claw, named("point")};
  const Lean lean{random.between(0, 360), random.between(-40, 80), random.between(-45, 45)};
  const HandPose pose = poses[random.below(poses.size())];
  return resting("odd", seed, pose, random, lean, random.between(4e-3, 25e-3), plate_of(random));
}
RatedHand two_people(std::uint64_t seed) {
  Random random(seed);
  const std::array poses{named("relaxed"), named("spread"), named("point"), named("fist")};
  RatedHand hand = begun("two-people", seed);
  hand.solids = {plate(plate_of(random))};
  const double apart = random.between(35e-3, 80e-3);
  for (const double side : {1.0, -1.0}) {
    const HandSkin& skin = hand_skin(poses[random.below(poses.size())], random.below(2) == 1);
    const Lean lean{(side > 0 ? 0 : 180) + random.between(-30, 30), random.between(15, 50), random.between(-10, 10)};
    const double deep = random.between(4e-3, 15e-3);
    // The tips face each other.
    const Transform T = leaning(skin, lean, random.between(0.85, 1.05));
    double foremost = -1;
    for (const Vec3& p : skin.mesh.positions) {
      const Vec3 world = transform_point(T, p);
      if (world.y < deep) foremost = std::max(foremost, -side * world.z);
    }
    add(hand, skin, at({random.between(-20e-3, 20e-3), -deep, side * (foremost + apart / 2)}, T));
  }
  hand.what = fmt::format("{:.0f} mm apart", apart * 1e3);
  return hand;
}
RatedHand thin(std::uint64_t seed) {
  Random random(seed);
  const std::array poses{named("spread"), named("relaxed"), together, named("fist")};
  const Lean lean{usual_turn(random), random.of(std::array{20.0, 45.0, 65.0, 88.0}) + random.between(-5, 5),
                  random.between(-10, 10)};
  const HandPose pose = varied(poses[random.below(4)], random.below(2));
  return resting("thin", seed, pose, random, lean, random.between(1e-3, 12e-3), 2e-3);
}
RatedHand back(std::uint64_t seed) {
  Random random(seed);
  const Lean lean{usual_turn(random), random.between(-100, -80), random.between(-8, 8)};
  const HandPose pose = varied(random.below(2) ? named("spread") : named("relaxed"), random.below(3));
  return resting("back", seed, pose, random, lean, random.between(2e-3, 10e-3), random.below(3) ? 2e-3 : 35e-3);
}
RatedHand rims(std::uint64_t seed) {
  Random random(seed);
  const std::array poses{named("spread"), named("relaxed"), together, named("point")};
  const Lean lean{usual_turn(random), random.between(15, 70), random.between(-10, 10)};
  const HandPose pose = varied(poses[random.below(4)], random.below(2));
  RatedHand hand = resting("rims", seed, pose, random, lean, random.between(2e-3, 12e-3), 35e-3);
  // The middle of the touch is on an edge of a small box.
  const double half = random.between(20e-3, 40e-3), angle = random.between(0, 360);
  const Vec3 way = transform_direction(turned({0, 1, 0}, angle), {0, 0, 1});
  const double far = half / std::max(std::abs(way.x), std::abs(way.z));
  hand.solids = {plate(random.of(std::array{3e-3, 20e-3, 40e-3}), half)};
  hand.bodies[0].pose = [T = at(way * far, hand.bodies[0].pose(0))](double) { return T; };
  hand.what += fmt::format(", at the edge of a box of {:.0f} mm", 2e3 * half);
  return hand;
}

/// Presses the skin so deep that `contacts_of` its true contacts are as many as wanted.
void press_to(RatedHand& hand, int contacts, double deepest_m, const std::function<int(const TrueFrame&)>& contacts_of) {
  const std::vector<HandBody> above = hand.bodies;
  double low = 0, high = deepest_m;
  const auto press = [&](double deep) {
    for (std::size_t b = 0; b < above.size(); ++b)
      hand.bodies[b].pose = [=, pose = above[b].pose](double t) { return at({0, -deep, 0}, pose(t)); };
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

RatedHand sparse(std::uint64_t seed) {
  Random random(seed);
  RatedHand hand = begun("sparse", seed);
  hand.solids = {plate(35e-3)};
  hand.cameras = ring(1, random.between(-55, -20), random.between(0, 360), random.between(0.5, 0.6));
  const double thick = random.between(14e-3, 17e-3), apart = thick + random.between(0, 2e-3),
               turn = random.between(0, 360), tilt = random.between(0, 55);
  for (const double k : {-1.0, 0.0, 1.0}) {
    const Transform turns = turned({0, 1, 0}, turn);
    add(hand, finger_skin(),
        at(transform_direction(turns, {k * apart, 0, 0}),
           standing(finger_skin(), turns * turned({1, 0, 0}, tilt) * scaled(thick / 18e-3), 2e-3)));
  }
  const int wanted = 24 + static_cast<int>(random.below(9));
  hand.what = fmt::format("three fingers of {:.1f} mm, {} contacts each, tilt {:.0f}", thick * 1e3, wanted, tilt);
  press_to(hand, 3 * wanted, 4e-3,
           [](const TrueFrame& frame) { return frame.contacts[0] + frame.contacts[1] + frame.contacts[2]; });
  return hand;
}

RatedHand hover(std::uint64_t seed) {
  Random random(seed);
  RatedHand hand = begun("hover", seed);
  hand.solids = {plate(plate_of(random))};
  hand.length_s = 2;
  const double above = random.between(0.1e-3, 0.2e-3);
  const Skin skin = pointer(random);
  add(hand, *skin.skin, at({0, above, 0}, skin.T));
  hand.what = fmt::format("{:.2f} mm above", above * 1e3);
  return hand;
}

// ---- hands that move ------------------------------------------------------------------------------------------------

/// Heights over time of a touch that comes down, stays and leaves.
struct Visit {
  double high_m = 12e-3, deep_m = 3e-3;
  double comes_s = 0.05, down_m_s = 0.2, leaves_s = 1e9, up_m_s = 0.2;

  double there_s() const { return comes_s + (high_m + deep_m) / down_m_s; }
  double height(double t) const {
    if (t > leaves_s) return std::min(high_m, up_m_s * (t - leaves_s) - deep_m);
    return std::clamp(high_m - down_m_s * (t - comes_s), -deep_m, high_m);
  }
};

void add_visit(RatedHand& hand, const Skin& skin, const Visit& visit, const Vec3& place = Vec3(0)) {
  hand.moves = true;
  add(hand, *skin.skin, [=](double t) { return at(place + Vec3(0, visit.height(t), 0), skin.T); });
}

RatedHand touch_and_leave(std::uint64_t seed) {
  Random random(seed);
  RatedHand hand = begun("touch", seed);
  hand.solids = {plate(plate_of(random))};
  Visit visit{.deep_m = random.between(1e-3, 6e-3)};
  visit.comes_s = 0.12 + random.between(0, 1 / hand.rate_hz);
  visit.down_m_s = random.of(std::array{0.05, 0.1, 0.2, 0.3});
  visit.leaves_s = visit.there_s() + random.between(0.25, 0.28);
  visit.up_m_s = random.of(std::array{0.05, 0.1, 0.2, 0.3});
  hand.length_s = visit.leaves_s + visit.deep_m / visit.up_m_s + 0.1;
  add_visit(hand, pointer(random), visit);
  hand.what = fmt::format("down at {:.0f} mm/s, {:.1f} mm deep, up at {:.0f} mm/s", visit.down_m_s * 1e3,
                          visit.deep_m * 1e3, visit.up_m_s * 1e3);
  return hand;
}

RatedHand leaving(const char* kind, std::uint64_t seed, std::optional<double> predict_s) {
  Random random(seed);
  RatedHand hand = begun(kind, seed);
  hand.solids = {plate(plate_of(random))};
  hand.predict_s = predict_s;
  Visit visit{.high_m = 20e-3, .deep_m = random.of(std::array{1e-3, 2e-3, 4e-3}), .comes_s = -10};
  visit.up_m_s = std::array{0.02, 0.1, 0.3}[seed / 3 % 3];
  hand.rate_hz = seed / 9 % 3 == 2 ? 30 : 90;
  visit.leaves_s = 0.2 + random.between(0, 1 / hand.rate_hz);
  hand.length_s = visit.leaves_s + visit.deep_m / visit.up_m_s + 0.15;
  add_visit(hand, pointer(random), visit);
  hand.what = fmt::format("from {:.0f} mm up at {:.0f} mm/s", visit.deep_m * 1e3, visit.up_m_s * 1e3);
  return hand;
}
RatedHand leave(std::uint64_t seed) {
  return leaving("leave", seed, std::nullopt);
}
RatedHand leave_ahead(std::uint64_t seed) {
  return leaving("leave-ahead", seed, 20e-3);
}

RatedHand sliding(const char* kind, std::uint64_t seed, std::optional<double> predict_s) {
  Random random(seed);
  RatedHand hand = begun(kind, seed);
  hand.solids = {plate(plate_of(random))};
  hand.predict_s = predict_s;
  const double speed = random.of(std::array{0.05, 0.1, 0.2, 0.3}), deep = random.between(2e-3, 6e-3);
  hand.length_s = std::min(hand.length_s, 0.11 / speed);
  const double half_s = hand.length_s / 2;
  const Vec3 way = transform_direction(turned({0, 1, 0}, random.between(0, 360)), {speed, 0, 0});
  Skin skin = pointer(random);
  if (random.below(3) == 0) {
    const HandSkin& whole = hand_skin(random.below(2) ? named("relaxed") : two_straight, random.below(2) == 1);
    skin = {&whole, leaning(whole, {usual_turn(random), random.between(15, 50), 0}, 1)};
  }
  hand.moves = true;
  add(hand, *skin.skin, [=](double t) { return at(way * (t - half_s) - Vec3(0, deep, 0), skin.T); });
  hand.what = fmt::format("{:.0f} mm/s, {:.1f} mm deep", speed * 1e3, deep * 1e3);
  return hand;
}
RatedHand slide(std::uint64_t seed) {
  return sliding("slide", seed, std::nullopt);
}
RatedHand slide_ahead(std::uint64_t seed) {
  return sliding("slide-ahead", seed, 20e-3);
}

RatedHand faint(std::uint64_t seed) {
  Random random(seed);
  RatedHand hand = begun("faint", seed);
  hand.solids = {plate(60e-3)};
  hand.predict_s = 20e-3;
  hand.length_s = 0.55;
  const double deep = random.between(0, 0.2e-3);
  const Vec3 way = transform_direction(turned({0, 1, 0}, random.between(0, 360)), {0.2, 0, 0});
  hand.moves = true;
  add(hand, finger_skin(), [=, T = fingertip(random)](double t) { return at(way * (t - 0.275) - Vec3(0, deep, 0), T); });
  hand.what = fmt::format("200 mm/s, {:.2f} mm deep", deep * 1e3);
  return hand;
}

RatedHand turning(std::uint64_t seed) {
  Random random(seed);
  RatedHand hand = begun("turning", seed);
  hand.solids = {plate(plate_of(random))};
  hand.predict_s = 20e-3;
  const double deep = random.between(2e-3, 5e-3);
  const bool rocks = random.below(2) == 0;
  hand.moves = true;
  Skin skin = pointer(random);
  if (random.below(3) == 0) {
    const HandSkin& two = hand_skin(two_straight, random.below(2) == 1);
    skin = {&two, leaning(two, {usual_turn(random), random.between(15, 45), 0}, 1)};
  }
  // About the vertical through the tip, or about a horizontal line 8 mm above it, as a finger that rolls.
  const Vec3 axis = rocks ? transform_direction(turned({0, 1, 0}, random.between(0, 360)), {1, 0, 0}) : Vec3(0, 1, 0);
  const double rate_deg = random.of(std::array{60.0, 120.0, 180.0}), swing_deg = rocks ? 15 : 40;
  const double hz = rate_deg / (2 * std::numbers::pi * swing_deg);
  add(hand, *skin.skin, [=](double t) {
    const double angle = swing_deg * std::sin(2 * std::numbers::pi * hz * t);
    const Vec3 pivot(0, 8e-3, 0);
    return at({0, -deep, 0}, at(pivot, turned(axis, angle) * at(-pivot, skin.T)));
  });
  hand.what = fmt::format("{} by {:.0f} degrees, at most {:.0f} degrees/s, {:.1f} mm deep", rocks ? "rolls" : "turns",
                          swing_deg, rate_deg, deep * 1e3);
  return hand;
}

RatedHand second(std::uint64_t seed) {
  Random random(seed);
  RatedHand hand = begun("second", seed);
  hand.solids = {plate(plate_of(random))};
  const double apart = random.between(19e-3, 32e-3), thick = random.between(15e-3, 19e-3),
               tilt = random.between(0, 55), deep = random.between(1e-3, 5e-3);
  const Transform turns = turned({0, 1, 0}, random.between(0, 360));
  const Transform T = standing(finger_skin(), turns * turned({1, 0, 0}, tilt) * scaled(thick / 18e-3), 2e-3);
  const Vec3 aside = transform_direction(turns, {apart / 2, 0, 0});
  Visit rests{.deep_m = random.between(1e-3, 5e-3), .comes_s = -10};
  Visit comes{.deep_m = deep, .comes_s = 0.12 + random.between(0, 1 / hand.rate_hz)};
  comes.down_m_s = random.of(std::array{0.05, 0.1, 0.2, 0.3});
  hand.length_s = comes.there_s() + 0.35;
  add_visit(hand, {&finger_skin(), T}, rests, -aside);
  add_visit(hand, {&finger_skin(), T}, comes, aside);
  hand.what = fmt::format("{:.1f} mm apart, {:.1f} mm thick, down at {:.0f} mm/s, {:.1f} mm deep", apart * 1e3,
                          thick * 1e3, comes.down_m_s * 1e3, deep * 1e3);
  return hand;
}

/// The tips of thumb and index finger, next to each other, equally low.
RatedHand pinch(std::uint64_t seed) {
  Random random(seed);
  RatedHand hand = begun("pinch", seed);
  hand.solids = {plate(plate_of(random))};
  const bool left = random.below(2) == 1;
  const HandSkin& skin = hand_skin(pinching, left);
  const auto tips = assets::fingertips(pinching);
  Vec3 across = tips[1].position - tips[0].position, down = tips[0].direction + tips[1].direction;
  if (left) across.x = -across.x, down.x = -down.x;
  across = glm::normalize(across);
  down = glm::normalize(down - across * glm::dot(down, across));
  const Transform T_local_world(Vec4(across, 0), Vec4(-down, 0), Vec4(glm::cross(across, -down), 0), Vec4(0, 0, 0, 1));
  const Transform T = standing(skin, turned({0, 1, 0}, usual_turn(random)) * turned({1, 0, 0}, random.between(-15, 15)) *
                                         glm::transpose(T_local_world) * scaled(random.between(0.88, 1.08)),
                               2e-3);
  add(hand, skin, T);
  hand.what = "thumb and index finger";
  press_to(hand, 44, 6e-3, [](const TrueFrame& frame) { return frame.contacts[1]; });
  const Visit visit{.deep_m = 0, .comes_s = 0.12 + random.between(0, 1 / hand.rate_hz), .down_m_s = 0.1};
  hand.moves = true;
  hand.bodies[0].pose = [=, deep = hand.bodies[0].pose](double t) { return at({0, visit.height(t), 0}, deep(t)); };
  hand.length_s = visit.there_s() + 0.45;
  return hand;
}

/// Two taps one after the other.
RatedHand taps(std::uint64_t seed) {
  Random random(seed);
  RatedHand hand = begun("taps", seed);
  hand.solids = {plate(plate_of(random))};
  const double hz = random.between(4, 8), deep = random.between(1e-3, 5e-3), high = random.between(4e-3, 10e-3),
               begins_s = 0.15 + random.between(0, 1 / hand.rate_hz);
  const Skin skin = pointer(random);
  hand.moves = true;
  add(hand, *skin.skin, [=](double t) {
    const double turns = std::clamp((t - begins_s) * hz, 0.0, 2.0);
    return at({0, (high - deep) / 2 + (high + deep) / 2 * std::cos(2 * std::numbers::pi * turns), 0}, skin.T);
  });
  hand.length_s = begins_s + 2 / hz + 0.15;
  hand.what = fmt::format("{:.1f} Hz, {:.1f} mm deep, {:.1f} mm high", hz, deep * 1e3, high * 1e3);
  return hand;
}

RatedHand pressing(const char* kind, std::uint64_t seed, double lowest_deg, double highest_deg) {
  Random random(seed);
  RatedHand hand = begun(kind, seed);
  hand.cameras = ring(1 + static_cast<int>(seed % 3), random.between(lowest_deg, highest_deg), random.between(0, 360),
                      random.between(0.35, 0.45));
  hand.solids = {plate(60e-3, 50e-3)};
  hand.solids[0].haptics.press_depth_m = 3e-3;
  Visit visit{.deep_m = random.between(4e-3, 6e-3)};
  visit.comes_s = 0.12 + random.between(0, 1 / hand.rate_hz);
  visit.down_m_s = random.of(std::array{0.05, 0.1, 0.2});
  visit.leaves_s = visit.there_s() + 0.5;
  hand.length_s = visit.leaves_s + 0.15;
  add_visit(hand, pointer(random), visit);
  hand.what = fmt::format("{:.1f} mm deep, cameras at {:.0f} mm height", visit.deep_m * 1e3,
                          hand.cameras[0].T_world_camera[3].y * 1e3);
  return hand;
}
RatedHand above(std::uint64_t seed) {
  return pressing("above", seed, 25, 60);
}
RatedHand beside(std::uint64_t seed) {
  return pressing("beside", seed, -8, 15);
}
RatedHand below(std::uint64_t seed) {
  return pressing("below", seed, -55, -25);
}

// ---- recordings -----------------------------------------------------------------------------------------------------

struct Recorded {
  const char *folder, *scene, *assets;  ///< the scene is in the shared folder, or one of the assets
  std::uint32_t fingers;
  std::optional<double> predict_s;
  bool slides;
};
constexpr Recorded recordings[] = {
    {"flicker/one-finger-through-semi-sphere", nullptr, "semi-sphere.glb", 1, {}, false},
    {"flicker/spread-hand-leaning", "flicker/plate-35mm.glb", nullptr, 5, {}, false},
    {"flicker/two-fingers-touching", "flicker/plate.glb", nullptr, 2, {}, false},
    {"hands-unsteady/palm-back-thin", "hands-unsteady/plate-2.glb", nullptr, 1, {}, false},
    {"hands-unsteady/faint-slide", "hands-unsteady/plate-60.glb", nullptr, 1, {}, true},
    {"hands-unsteady/faint-slide", "hands-unsteady/plate-60.glb", nullptr, 1, 20e-3, true},
};
constexpr std::uint64_t first_recording = 26000;

RatedHand recorded(std::uint64_t seed) {
  const Recorded& entry = recordings[(seed - first_recording) % std::size(recordings)];
  RatedHand hand{.kind = "recorded", .seed = seed, .what = entry.folder};
  hand.recording = shared_data(entry.folder);
  if (hand.recording.empty()) throw bad_usage(fmt::format("no shared recording {}", entry.folder));
  const sensing::Recording recording = sensing::load_recording(hand.recording);
  hand.cameras = recording.cameras;
  hand.solids = geometry::make_solids(geometry::load_gltf(
      entry.assets ? source_file(std::string("assets/") + entry.assets) : shared_data(entry.scene)));
  hand.length_s = (static_cast<double>(recording.entries.size()) + 0.5) / hand.rate_hz;
  hand.predict_s = entry.predict_s;
  hand.fingers = entry.fingers;
  hand.slides = entry.slides;
  if (entry.predict_s) hand.what += ", predicted";
  return hand;
}

constexpr HandClass classes[] = {
    {"fist", 1000, 16, fist, "fists at rest"},
    {"spread", 2000, 16, spread, "spread fingers through the surface"},
    {"flat", 3000, 16, flat, "flat palms"},
    {"touching", 4000, 16, touching, "fingers that touch each other"},
    {"relaxed", 5000, 16, relaxed, "relaxed hands"},
    {"leaning", 6000, 16, leans, "hands that lean far"},
    {"odd", 7000, 18, odd, "other poses, from any side"},
    {"two-people", 8000, 12, two_people, "two people's hands"},
    {"touch", 9000, 18, touch_and_leave, "a finger comes, stays and leaves"},
    {"leave", 10000, 18, leave, "withdrawals at 20, 100 and 300 mm/s"},
    {"leave-ahead", 11000, 18, leave_ahead, "the same, predicted by 20 ms"},
    {"slide", 12000, 15, slide, "slides at 50 to 300 mm/s"},
    {"slide-ahead", 13000, 15, slide_ahead, "the same, predicted by 20 ms"},
    {"thin", 14000, 16, thin, "hands in a plate of 2 mm"},
    {"back", 15000, 16, back, "the back of a hand, mostly in a plate of 2 mm"},
    {"rims", 16000, 16, rims, "hands at the edge of a small box"},
    {"sparse", 17000, 15, sparse, "one camera, three close fingers of 24 to 32 contacts"},
    {"above", 18000, 12, above, "a finger presses, cameras above"},
    {"beside", 19000, 12, beside, "the same, cameras beside"},
    {"below", 20000, 12, below, "the same, cameras below"},
    {"hover", 21000, 12, hover, "0.1 to 0.2 mm above the surface, for 2 s"},
    {"taps", 22000, 15, taps, "double taps at 4 to 8 Hz, 1 to 5 mm deep"},
    {"faint", 23000, 15, faint, "0 to 0.2 mm deep at 200 mm/s, predicted by 20 ms"},
    {"pinch", 24000, 15, pinch, "thumb and index finger come down, 44 contacts"},
    {"turning", 25000, 15, turning, "fingers that turn and roll, predicted by 20 ms"},
    {"recorded", first_recording, std::size(recordings), recorded, "the shared recordings"},
    {"second", 27000, 18, second, "a second finger comes beside one that rests"},
};

}  // namespace

std::span<const HandClass> hand_classes() {
  return classes;
}

RatedHand make_hand_of(const HandClass& kind, std::uint64_t seed) {
  RatedHand hand = kind.make(seed);
  hand.what += fmt::format("; {} cameras, {:.0f} Hz", hand.cameras.size(), hand.rate_hz);
  return hand;
}

}  // namespace palpa::test
