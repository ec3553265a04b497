// How the classes of hand_rates make their hands.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "assets/generators/hand.hpp"
#include "hand_classes.hpp"
#include "hand_truth.hpp"

namespace palpa::test::hands {

using assets::HandPose;

/// The same numbers from every standard library.
class Random {
 public:
  explicit Random(std::uint64_t seed) : bits_(seed) {}
  double between(double low, double high) { return low + (high - low) * static_cast<double>(bits_() >> 11) * 0x1p-53; }
  std::size_t below(std::size_t count) { return static_cast<std::size_t>(bits_() % count); }
  bool coin() { return below(2) == 1; }
  template <typename T, std::size_t N>
  T of(const std::array<T, N>& values) {
    return values[below(N)];
  }

 private:
  std::mt19937_64 bits_;
};

// ---- poses ----------------------------------------------------------------------------------------------------------

HandPose named(const char* name);
/// Straight fingers that touch each other.
HandPose fingers_together();
/// The tips of thumb and index finger are 2 mm apart, the other fingers are bent, or straight.
HandPose pinching();
HandPose ring_of_two();
HandPose two_straight();
HandPose three_straight();
HandPose claw();
/// One of three people's: their joints bend differently.
HandPose varied(HandPose pose, std::size_t who);
/// One of these poses, of one of so many people.
template <std::size_t N>
HandPose one_of(Random& random, const std::array<HandPose, N>& poses, std::size_t people) {
  const HandPose pose = random.of(poses);
  return varied(pose, random.below(people));
}

// ---- solids and cameras ---------------------------------------------------------------------------------------------

/// Its top is at y = 0.
geometry::Solid plate(double thick_m, double half_m = 0.3);
/// Thicker than any finger reaches.
double thick_plate(Random& random);
std::vector<sensing::Camera> ring(std::size_t count, double elevation_deg, double azimuth_deg, double distance_m);
/// The first cameras of the paper's rig, 30 or 90 Hz.
RatedHand begun(std::uint64_t seed, int cameras);

// ---- skin -----------------------------------------------------------------------------------------------------------

Transform at(const Vec3& place, Transform T);
Transform scaled(double factor);
/// Skin whose lowest place is at y = 0, moved so that what is at most `deep_m` higher is around the origin.
Transform standing(const HandSkin& skin, Transform T, double deep_m = 10e-3);

struct Lean {
  double turn_deg = 0;  ///< about the vertical; 0: the hand comes from +z
  double tilt_deg = 0;  ///< towards the palm; 90: it lies on its palm, -90: on its back
  double roll_deg = 0;  ///< about its own length
};
Transform leaning(const HandSkin& skin, const Lean& lean, double scale);
double usual_turn(Random& random);
double usual_scale(Random& random);

/// Skin, and a pose in which its lowest place is at y = 0.
struct Standing {
  const HandSkin* skin = nullptr;
  Transform T{1.0};
};
/// A fingertip that leans by at most so much; 0: 14 to 20 mm thick.
Standing fingertip(Random& random, double tilt_most_deg = 60, double thick_m = 0);
/// A hand whose index finger points.
Standing pointing(Random& random);
/// One of these two.
Standing pointer(Random& random);

void add(RatedHand& hand, const HandSkin& skin, sensing::Motion pose);
void add(RatedHand& hand, const HandSkin& skin, const Transform& T);

/// A row of fingers, `apart_m` from each other, `deep_m` deep. `turn_deg` turns the row's direction away from +x, and
/// the fingers lean at right angles to it.
void add_row(RatedHand& hand, std::size_t count, double thick_m, double apart_m, double turn_deg, double tilt_deg,
             const std::function<double()>& deep_m);

/// Moves all skin down, at most by `deepest_m`, until `contacts_of` the truth is at least `contacts`.
void press_to(RatedHand& hand, int contacts, double deepest_m, const std::function<int(const TrueFrame&)>& contacts_of);

// ---- the classes ----------------------------------------------------------------------------------------------------

using Make = void(RatedHand& hand, Random& random);
Make fist, spread, flat, palm, touching, relaxed, leans, leans_away, odd, two_people, thin, through, back, rims, sparse,
    hover;
Make touch_and_leave, landing, second_finger, pinch, taps, leave, slide, faint, turning, meeting, above, beside, below;

}  // namespace palpa::test::hands
