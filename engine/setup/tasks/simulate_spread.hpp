// What random arrays make of the radiation pressure on a finger: `palpa simulate --spread`.
#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "acoustics/bodies/rigid_body.hpp"
#include "array/field/directivity.hpp"
#include "array/layouts/layout.hpp"
#include "base/files/json_rows.hpp"
#include "base/math.hpp"
#include "session/previews/skin_pressure.hpp"
#include "setup/options/options.hpp"
#include "setup/options/spread.hpp"

namespace palpa::setup {

/// The numbers of acoustics::Spot.
struct SpotSpread {
  Percentiles peak_pa;
  std::array<Percentiles, 3> peak_m;  ///< x, y, z of the loudest face's centroid
  Percentiles half_area_m2, half_radius_m, elongation;
};

/// Metres in the world, Pa, N and Nm, as in SimulateResult.
struct SimulateSpread {
  Draws draws;
  SpotSpread langevin, squared;
  std::array<Percentiles, 3> force, torque;  ///< x, y, z
};
/// The members of the object "spread".
const JsonRows<SimulateSpread>& simulate_spread_rows();

/// The sound of a touch as designed.
struct DesignedTouch {
  const session::Sounds& sounds;
  const array::Layout& layout;  ///< in the world
  array::Directivity directivity;
  const MediumOptions& medium;
  const AirOptions& air;
  std::shared_ptr<const acoustics::RigidBody> body;  ///< for that air
  Vec3 tip{0};                                       ///< torques are about it
};
/// The same numbers for arrays as built (array/layouts/as_built.hpp). If the temperature varies, the equations are
/// solved at five temperatures, from 2.5 standard deviations below to 2.5 above, and results between them are
/// interpolated (session/previews/skin_as_built.hpp). Two of these bodies are in memory at a time, beside `touch.body`.
/// Uses all cores; a draw takes as long as the pressure of the touch itself.
SimulateSpread spread_of_pressure(const DesignedTouch& touch, const array::Spread& spread, const Draws& draws);

}  // namespace palpa::setup
