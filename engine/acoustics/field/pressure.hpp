// The forward model: the sound of a drive at a point. Free field, linear.
//
//   p = level * sum over transducers of amplitude e^{i phase} D(angle) e^{(ik - alpha) r} / r
//
// level is the layout's source level, D the directivity about the transducer's axis. Nearer than its own radius, a
// transducer is not a point source, and 1/r stays at 1/radius. For many points at once: incident.hpp.
#pragma once

#include <complex>
#include <span>
#include <vector>

#include "array/drive_options.hpp"
#include "array/field/directivity.hpp"
#include "array/field/transfer.hpp"
#include "array/layouts/layout.hpp"
#include "array/transducer_drive.hpp"

namespace palpa::acoustics {

/// Complex pressure in Pa, peak, time factor e^{-iwt}, in double precision. `drive` has one entry per transducer;
/// `point` in metres, in the layout's frame as posed. `absorption_np_m` is alpha (air.hpp).
std::complex<double> pressure_at(const array::Layout& layout, std::span<const array::TransducerDrive> drive,
                                 const Vec3& point, const array::Medium& medium = {},
                                 array::Directivity directivity = array::Directivity::t4010a1,
                                 double absorption_np_m = 0);

/// The pressure of a drive at the foci that it was made for.
struct FociPressure {
  std::vector<double> pascals;  ///< |p| at each focus, peak; 0 if a focus is not drivable
  double mean = 0;              ///< mean of `pascals` over the foci with a gain above 0; 0 if there are none
  /// Minimum divided by maximum of |p| / gain, over the foci with a gain above 0: 1 if all are as strong as requested.
  /// 1 for fewer than two.
  double evenness = 1;
};
/// Without absorption, as in the solvers.
FociPressure pressure_at_foci(const array::Layout& layout, std::span<const array::TransducerDrive> drive,
                              std::span<const array::SlotFocus> foci, const array::Medium& medium = {},
                              array::Directivity directivity = array::Directivity::t4010a1);
/// The same if another transfer replaces the free field (array::DriveOptions::transfer).
FociPressure pressure_at_foci(const array::Layout& layout, std::span<const array::TransducerDrive> drive,
                              std::span<const array::SlotFocus> foci, const array::Transfer& transfer);

}  // namespace palpa::acoustics
