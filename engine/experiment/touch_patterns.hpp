// The pressure on a finger over time, for one place of the finger and several methods.
#pragma once

#include <atomic>
#include <span>
#include <string>
#include <vector>

#include "array/field/directivity.hpp"
#include "array/layouts/layout.hpp"
#include "experiment/observed_finger.hpp"
#include "geometry/solid.hpp"
#include "observer/afferents/finger_place.hpp"
#include "observer/afferents/pressure_pattern.hpp"
#include "session/plan/plan.hpp"
#include "study/plan/plan_method.hpp"

namespace palpa::experiment {

/// The object that is touched, and how deep the finger's lowest point is below the object's top.
struct TouchedScene {
  std::string file;
  const std::vector<geometry::Solid>& solids;
  double depth_m = 0;
};

/// A method with its array, posed in the world.
struct ObservedMethod {
  study::PlanMethod method;
  const array::Layout* layout = nullptr;
};

struct TouchPattern {
  observer::PressurePattern pattern;  ///< without maps if nothing is touched
  double crest_n = 0;                 ///< the largest force of a map on the whole finger
};

/// One for each plan: the radiation pressure of each of its drives (Langevin) on the faces of the finger's sites. The
/// plans are for this layout, which is in the world, and their drives are listed; a plan without drives has no maps.
/// Throws bad_input if the finger stands within the array, GivenUp (base/system/parallel.hpp) soon after `give_up`
/// became true.
std::vector<TouchPattern> patterns_of(ObservedFinger& finger, const Transform& T_world_finger,
                                      const array::Layout& layout, std::span<const session::Plan> plans,
                                      array::Directivity directivity, const std::atomic<bool>* give_up = nullptr);

/// One for each method: foci and drives as in a live run, and the radiation pressure of each drive (Langevin) on the
/// faces of the finger's sites. The finger is turned about its own axis and moved to `place`. Methods with the same
/// layout cost little more than one. Throws bad_input if the finger stands within the array, otherwise as touch_once
/// does.
std::vector<TouchPattern> touch_patterns(ObservedFinger& finger, const TouchedScene& scene,
                                         const observer::FingerPlace& place, std::span<const ObservedMethod> methods);

}  // namespace palpa::experiment
