// What is true of a hand of hand_rates, from its model and from pictures of it without noise.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "hand_classes.hpp"
#include "touch/stage.hpp"

namespace palpa::test {

/// A moment of a hand.
struct TrueFrame {
  std::vector<Transform> T_world_body, T_body_world;
  std::vector<int> contacts;   ///< per part: skin in the shell in the pictures without noise
  std::vector<Vec3> centroid;  ///< per part: of these contacts
  std::vector<bool> of_palm;   ///< per part: a digit whose contacts continue those of its palm
  /// Per part: of its deepest skin, seen or not; outside of the solids negative. Digits that continue a palm are part
  /// of it.
  std::vector<double> depth_m;
  std::uint32_t fingers = 0;          ///< with at least min_points contacts; patches of a palm count
  std::uint32_t least = 0, most = 0;  ///< the numbers that noise leaves possible
};

/// Follows one hand.
class HandTruth {
 public:
  explicit HandTruth(const RatedHand& hand);
  ~HandTruth();

  /// Valid until the next call.
  const TrueFrame& at(double time_s);
  /// Only the poses and depths.
  TrueFrame depths_at(double time_s) const;
  /// The part whose skin is nearest to a place. Digits that continue a palm are the palm.
  std::uint32_t part_at(const TrueFrame& frame, const Vec3& place) const;
  /// Where the skin of that part that was at `place` at one moment is at another, in metres from there.
  Vec3 way_of(std::uint32_t part, const Vec3& place, double from_s, double to_s) const;
  std::uint32_t body_of(std::uint32_t part) const;

 private:
  void count(TrueFrame& frame);

  struct Finder;
  const RatedHand& hand_;
  std::vector<std::unique_ptr<Finder>> finders_;
  sensing::SyntheticRig rig_;
  touch::Stage stage_;
  touch::Touch touch_;
  sensing::FrameSet set_;
  TrueFrame frame_;
  bool counted_ = false;
};

}  // namespace palpa::test
