// The air that sound goes through: from temperature, humidity and pressure to sound speed, density and absorption.
//
//   c     = 331.3 sqrt(1 + T / 273.15) m/s, T in degrees Celsius (array/medium.hpp)
//   rho   = p / (287.05 (T + 273.15)) kg/m3, dry air: 1.204 at 20 degrees and 101325 Pa
//   alpha = ISO 9613-1, equations 3 to 5 and B.2, B.3, in Np/m: amplitudes fall as e^{-alpha r}. 0.152 at 20 degrees,
//           50 %, 101325 Pa and 40 kHz, which is 1.318 dB/m
//
// The standard vouches for alpha within 10 % from -20 to 50 degrees up to 10 Hz per Pa of air pressure, a megahertz at
// sea level.
#pragma once

#include <optional>

#include "array/medium.hpp"

namespace palpa::acoustics {

/// What a thermometer, a hygrometer and a barometer show.
struct Weather {
  double celsius = 20;
  double humidity_percent = 50;  ///< relative
  double pressure_pa = 101325;
};
/// What is taken, both ends included; temperatures as in array/medium.hpp.
inline constexpr double least_air_pressure_pa = 20e3, most_air_pressure_pa = 500e3;

/// What sound makes of it.
struct Air {
  array::Medium medium;
  double density_kg_m3 = 0;
  double absorption_np_m = 0;  ///< 0: none

  double wave_number() const;       ///< 1/m
  double stiffness_pa() const;      ///< rho c^2
  double impedance_pa_s_m() const;  ///< rho c
};

/// `hz` is the tone. A sound speed that is given takes the place of the temperature's, and of nothing else. Throws
/// bad_usage where a value is outside of what is taken.
Air air_of(const Weather& weather, double hz = 40e3, const std::optional<double>& sound_speed = {});
/// The same air, in which nothing is absorbed.
Air without_absorption(Air air);

}  // namespace palpa::acoustics
