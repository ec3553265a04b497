// Where a finger can be over an object: the prior of the ideal observer.
#pragma once

#include <cstdint>
#include <vector>

#include "observer/afferents/finger_place.hpp"

namespace palpa::observer {

/// Standard deviations of a normal distribution of places.
struct PlacePrior {
  double lateral_m = 2e-3;  ///< of x and of z
  double yaw_rad = 0.261799387799149;
};

/// `count` places that represent the prior evenly: normal quantiles of an additive recurrence in three dimensions. The
/// same places for every shape and method.
std::vector<FingerPlace> places_of(const PlacePrior& prior, std::uint32_t count);

}  // namespace palpa::observer
