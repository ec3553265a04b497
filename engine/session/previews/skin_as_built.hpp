// The radiation pressure on rigid skin of an array that is not exactly its layout, in air that is not exactly as warm
// as expected (array/layouts/as_built.hpp).
#pragma once

#include <memory>
#include <span>

#include "acoustics/air.hpp"
#include "acoustics/bodies/radiation.hpp"
#include "acoustics/bodies/rigid_body.hpp"
#include "array/field/directivity.hpp"
#include "array/layouts/as_built.hpp"
#include "session/previews/skin_pressure.hpp"

namespace palpa::session {

/// A body with its equations for the air at one temperature.
struct WarmBody {
  double celsius = 20;
  acoustics::Air air;
  std::shared_ptr<const acoustics::RigidBody> body;
};

/// The time average over `sounds`, as mean_pressure has it, played by the array `built`. That is a draw for a drive
/// with full amplitude and phase 0 everywhere, so built.drive holds the factors of the strengths.
///
/// The incident wave is that in `air`, which has the temperature `celsius`. `bodies` are one body or two: the same mesh
/// for different air. The equations of two are solved for the same wave, and all results are interpolated linearly
/// between their temperatures, or extrapolated if `celsius` is not between them.
acoustics::SkinPressure pressure_as_built(const Sounds& sounds, const array::AsBuilt& built, double celsius,
                                          const acoustics::Air& air, array::Directivity directivity,
                                          std::span<const WarmBody> bodies);

}  // namespace palpa::session
