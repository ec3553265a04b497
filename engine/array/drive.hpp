// Drives: what every transducer does for one slot.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "array/layout.hpp"
#include "base/math.hpp"

namespace palpa::array {

/// How the amplitude of one focus spreads over the transducers.
enum class Weighting { distance, uniform };
/// How summed amplitudes are brought into 0..1.
enum class Constraint { normalise, uniform, clamp };

struct Medium {
  double sound_speed = 343.21;  ///< m/s
  double frequency = 40e3;      ///< Hz
  double turns_per_metre() const { return frequency / sound_speed; }
};
/// c = 331.3 sqrt(1 + T/273.15), T in degrees Celsius.
double sound_speed_at(double celsius);

/// One focus that sounds in a slot; several in one slot belong to different fingers.
struct SlotFocus {
  Vec3 position;    ///< metres, in the layout's frame as posed
  float gain = 1;   ///< 0..1, the finger's amplitude modulation and intensity
};

/// Amplitude 0..1 and phase in (-pi, pi] of one transducer, e^{-iwt}: the phase is the delay, -k d for a single focus.
struct TransducerDrive {
  float amplitude;
  float phase;
};
using Drive = std::vector<TransducerDrive>;  ///< in layout order

}  // namespace palpa::array
