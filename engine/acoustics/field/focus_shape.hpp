// How wide a focus is, and how much it presses: what arrays are compared by.
#pragma once

#include "acoustics/air.hpp"
#include "acoustics/field/incident.hpp"
#include "array/layout.hpp"
#include "base/math.hpp"

namespace palpa::acoustics {

/// A board of `count` x `count` transducers, neighbours `pitch_m` apart, around the origin in z = 0, sounding towards
/// +z; all else as a Layout has it.
array::Layout square_board(int count, double pitch_m);

/// Full width at half maximum of |p| in metres, along a line through `focus`, of which 8 mm on either side are looked
/// at, in steps of 0.02 mm.
double focus_width(const Incident& incident, const Strengths& strengths, const Vec3& focus, const Vec3& along);

/// |p|^2 / (rho c^2) of the incident sound, which is what a wall that reflects all of it would feel, over a disc around
/// `focus` at right angles to z, newtons.
double disc_force(const Incident& incident, const Strengths& strengths, const Air& air, const Vec3& focus,
                  double radius_m);

}  // namespace palpa::acoustics
