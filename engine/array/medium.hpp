// The air and the tone.
#pragma once

namespace palpa::array {

struct Medium {
  double sound_speed = 343.21;  ///< m/s; 20 degrees Celsius
  double frequency = 40e3;      ///< Hz
  double turns_per_metre() const { return frequency / sound_speed; }
};
/// Accepted ranges for air and ultrasound, both ends included. Values outside are unit errors.
inline constexpr double least_celsius = -60, most_celsius = 100;
inline constexpr double least_sound_speed = 100, most_sound_speed = 2000;  ///< m/s
inline constexpr double least_frequency = 1e3, most_frequency = 10e6;      ///< Hz

/// c = 331.3 sqrt(1 + T/273.15), T in degrees Celsius. Throws bad_usage outside least_celsius to most_celsius.
double sound_speed_at(double celsius);

}  // namespace palpa::array
