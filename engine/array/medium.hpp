// The air and the tone.
#pragma once

namespace palpa::array {

struct Medium {
  double sound_speed = 343.21;  ///< m/s; 20 degrees Celsius
  double frequency = 40e3;      ///< Hz
  double turns_per_metre() const { return frequency / sound_speed; }
};
/// c = 331.3 sqrt(1 + T/273.15), T in degrees Celsius. Throws bad_usage at or below absolute zero.
double sound_speed_at(double celsius);

}  // namespace palpa::array
