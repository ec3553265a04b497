// Skin as an elastic half-space (E = 0.05 N/mm2, nu = 0.4): stress below loads, and the deflection of its surface.
// Lengths are in mm, forces in N, stresses in N/mm2.
#pragma once

namespace palpa::observer {

inline constexpr double skin_modulus = 0.05;  ///< E, N/mm2
inline constexpr double skin_poisson = 0.4;   ///< nu
/// The speed of surface waves, m/s, as in TouchSim. Skin of that E would carry them at 4 m/s
/// (docs/afferents.md#limits).
inline constexpr double usual_wave_m_s = 8;

/// E / (1 - nu^2), N/mm2.
inline constexpr double skin_stiffness = skin_modulus / (1 - skin_poisson * skin_poisson);

/// The vertical stress at depth z and distance r from a force of 1 N on a point: 3 z^3 / (2 pi (r^2 + z^2)^2.5).
double stress_of_point(double z, double r);

/// The surface's deflection at distance r from the centre of a disc of radius a with a pressure of 1 N/mm2:
///
///   w = 4 a / (pi E') E(r/a) for r <= a,   w = 4 r / (pi E') (E(a/r) - (1 - a^2/r^2) K(a/r)) outside
///
/// K and E are the complete elliptic integrals of the modulus, E' is skin_stiffness.
double deflection_of_disc(double a, double r);

}  // namespace palpa::observer
