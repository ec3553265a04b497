// The registration of a tracker of hands, in `palpa calibrate --nudge`: four foci sound one after the other, and a
// person touches each with the tip of one index finger. Where the tracker saw the tip gives the tracker's pose. Metres.
#pragma once

#include <array>
#include <cstddef>
#include <deque>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "array/layouts/layout.hpp"
#include "base/math.hpp"
#include "sensing/joints/tracked_hand.hpp"
#include "session/links/sources.hpp"
#include "session/plan/scheduler.hpp"
#include "setup/tasks/touch_steps.hpp"

namespace palpa::setup {

/// Where the foci sound before they are nudged, in the world: around its origin, where objects are.
inline constexpr std::array<Vec3, 4> registration_foci{
    {{-0.04, 0, -0.03}, {0.04, 0, -0.03}, {0, 0, 0.04}, {0, 0.05, 0}}};

/// A focus, and the index tip that touched it, as the tracker saw the joint.
struct TouchedFocus {
  Vec3 focus_m{};  ///< world
  Vec3 tip_m{};    ///< in the tracker's frame
  double radius_m = 0;
};

struct Registration {
  Transform T_world_joints{1.0};
  double residual_m = 0;      ///< rms distance of the tips from where the foci say they were
  std::vector<double> off_m;  ///< the distances
};
/// The way from a focus to the array, a unit vector; zero if the array is all around it.
Vec3 towards_array(const array::Layout& layout, const Vec3& focus);

/// The rigid transform with the least squares (rigid_fit.hpp). The skin that touches a focus faces the array: the
/// joint lies a radius farther away than the focus. For an array that is all around a focus, the joint is at the focus.
/// Throws failure if the tips lie nearly on a line, or if they remain more than 10 mm off (rms).
Registration register_tracker(std::span<const TouchedFocus> touches, const array::Layout& layout);

/// The touches of a run. Its source, its method and its keys use it on three threads.
class FocusTouches final : public TouchSteps {
 public:
  /// The source `joints`: while the tracker sees one hand, there is a fingertip in the top of assets/cube.glb, so that
  /// the focus sounds.
  session::SourceKind source();
  /// Places the current focus.
  session::OwnMethod method();

  void nudge(const Vec3& offset) override;
  std::string take(double time_s) override;
  std::string line() const override;
  bool complete() const override { return touches().has_value(); }
  /// nullopt until all foci were touched.
  std::optional<std::vector<TouchedFocus>> touches() const;

  /// The hands of a frame.
  void see(const sensing::TrackedFrame& frame);

 private:
  struct Tip {
    double time_s = 0;
    Vec3 place_m{};
    double radius_m = 0;
  };
  Vec3 focus() const;

  mutable std::mutex mutex_;
  std::deque<Tip> tips_;  ///< of the last second
  Vec3 offset_{0};
  std::vector<TouchedFocus> touches_;
};

}  // namespace palpa::setup
