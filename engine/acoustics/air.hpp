// The properties of air: sound speed, density and absorption from temperature, humidity and pressure.
//
//   c     = 331.3 sqrt(1 + T / 273.15) m/s, T in degrees Celsius (array/medium.hpp)
//   rho   = p / (287.05 (T + 273.15)) kg/m3, dry air: 1.204 at 20 degrees and 101325 Pa
//   alpha = ISO 9613-1, equations 3 to 5 and B.2, B.3, in Np/m: amplitudes fall as e^{-alpha r}. 0.152 at 20 degrees,
//           50 %, 101325 Pa and 40 kHz, which is 1.318 dB/m
//
// The standard guarantees alpha within 10 % from -20 to 50 degrees, up to 10 Hz per Pa of air pressure (a megahertz at
// sea level).
#pragma once

#include <optional>

#include "array/medium.hpp"

namespace palpa::acoustics {

/// The readings of a thermometer, a hygrometer and a barometer.
struct Weather {
  double celsius = 20;
  double humidity_percent = 50;  ///< relative
  double pressure_pa = 101325;
};
/// Accepted range, both ends included; temperatures as in array/medium.hpp.
inline constexpr double least_air_pressure_pa = 20e3, most_air_pressure_pa = 500e3;

/// The resulting properties of the air for sound.
struct Air {
  array::Medium medium;
  double density_kg_m3 = 0;
  double absorption_np_m = 0;  ///< 0: no absorption

  double wave_number() const;   ///< 1/m
  double stiffness_pa() const;  ///< rho c^2
};

/// `hz` is the frequency of the tone. A given sound speed replaces only the speed that follows from the temperature.
/// Throws bad_usage if a value is outside the accepted range.
Air air_of(const Weather& weather, double hz = 40e3, const std::optional<double>& sound_speed = {});
/// The same air without absorption.
Air without_absorption(Air air);

}  // namespace palpa::acoustics
