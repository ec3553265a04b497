// Width and force of a focus, for comparing arrays.
#pragma once

#include "acoustics/air.hpp"
#include "acoustics/field/incident.hpp"
#include "array/layouts/layout.hpp"
#include "base/math.hpp"

namespace palpa::acoustics {

/// A board of `count` x `count` transducers, neighbours `pitch_m` apart, around the origin in z = 0, sounding towards
/// +z; everything else as in a default Layout.
array::Layout square_board(int count, double pitch_m);

/// Full width at half maximum of |p| in metres, along a line through `focus`, searched up to 8 mm on either side in
/// steps of 0.02 mm.
double focus_width(const Incident& incident, const Strengths& strengths, const Vec3& focus, const Vec3& along);

/// The integral of |p|^2 / (rho c^2) of the incident sound, the pressure on a wall that reflects all of it, over a disc
/// around `focus` at right angles to z, newtons.
double disc_force(const Incident& incident, const Strengths& strengths, const Air& air, const Vec3& focus,
                  double radius_m);

}  // namespace palpa::acoustics
