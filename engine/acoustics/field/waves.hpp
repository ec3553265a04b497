// Analytic incident waves, without an array.
#pragma once

#include <span>

#include "acoustics/field/incident.hpp"

namespace palpa::acoustics {

/// e^{ik d.x}, `direction` a unit vector, and its slopes along the normals: 1 Pa, phase 0 at the origin.
Waves plane_wave(double wave_number, const Vec3& direction, std::span<const Vec3> points,
                 std::span<const Vec3> normals);

/// e^{ikr} / r, where r is the distance from `source` in metres.
Waves point_source(double wave_number, const Vec3& source, std::span<const Vec3> points, std::span<const Vec3> normals);

}  // namespace palpa::acoustics
