// The forward model: what a drive sounds like at a point. Free field, linear.
//
//   p = level * sum over transducers of amplitude e^{i phase} D(angle) e^{(ik - alpha) r} / r
//
// level being the layout's source level, D the directivity about the transducer's axis. Nearer than its own radius a
// transducer is no point, and 1/r stays at 1/radius there. At many points at once: incident.hpp.
#pragma once

#include <complex>
#include <span>
#include <vector>

#include "array/directivity.hpp"
#include "array/drive.hpp"
#include "array/layout.hpp"

namespace palpa::acoustics {

/// Complex pressure in Pa, peak, time factor e^{-iwt}, in double precision. `drive` has one entry per transducer;
/// `point` in metres, in the layout's frame as posed. `absorption_np_m` is alpha (air.hpp).
std::complex<double> pressure_at(const array::Layout& layout, std::span<const array::TransducerDrive> drive,
                                 const Vec3& point, const array::Medium& medium = {},
                                 array::Directivity directivity = array::Directivity::t4010a1,
                                 double absorption_np_m = 0);

/// What a drive gives at the foci that it was made for.
struct FociPressure {
  std::vector<double> pascals;  ///< |p| at each focus, peak; 0 where a focus is not drivable
  double mean = 0;              ///< of the above over the foci with a gain above 0; 0 without any
  /// Weakest over strongest of |p| / gain, over the foci with a gain above 0: 1 where all are as strong as asked. 1 for
  /// fewer than two.
  double evenness = 1;
};
/// Without absorption, as in the solvers.
FociPressure pressure_at_foci(const array::Layout& layout, std::span<const array::TransducerDrive> drive,
                              std::span<const array::SlotFocus> foci, const array::Medium& medium = {},
                              array::Directivity directivity = array::Directivity::t4010a1);
/// The same where another sound is in the free field's place (array::DriveOptions::transfer).
FociPressure pressure_at_foci(const array::Layout& layout, std::span<const array::TransducerDrive> drive,
                              std::span<const array::SlotFocus> foci, const array::Transfer& transfer);

}  // namespace palpa::acoustics
