// Drives: what every transducer does for one slot.
//
// The paper's q_k (Sec. III-F) under the time factor e^{-iwt}: a focus f asks of the transducer at distance d the
// amplitude d / max d (or 1) and the phase -k d. What follows when several foci sound in one slot:
//
//   q_j      complex amplitude that focus j asks, its own largest |q_j| being 1
//   g        shared gain: the largest of the foci's gains
//   r_j      relative gain: gain_j / g, and 1 where g is 0
//   S        sum over j of q_j; G: sum over j of r_j q_j
//   amplitude = g * constraint(G), phase = arg G
//
//   normalise: |G| / max |S|, the largest taken over all transducers; uniform: 1; clamp: |G|; never above 1
//
// The largest |S| knows no gains: normalising |G| by its own largest value would undo the modulation. A gain that all
// foci share is therefore exactly one scalar over the whole drive, phases untouched; where fingers differ, each focus'
// share of the sum is modulated, under `uniform` by way of the phases alone. One focus is exactly the paper's q_k times
// its gain.
#pragma once

#include <complex>
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
  double sound_speed = 343.21;  ///< m/s; 20 degrees Celsius
  double frequency = 40e3;      ///< Hz
  double turns_per_metre() const { return frequency / sound_speed; }
};
/// c = 331.3 sqrt(1 + T/273.15), T in degrees Celsius. Throws bad_usage at or below absolute zero.
double sound_speed_at(double celsius);

/// One focus that sounds in a slot; several in one slot belong to different fingers.
struct SlotFocus {
  Vec3 position;   ///< metres, in the layout's frame as posed
  float gain = 1;  ///< 0..1, the finger's amplitude modulation and intensity
};

/// Amplitude 0..1 and phase in (-pi, pi] of one transducer, e^{-iwt}: the phase is the delay, -k d for a single focus.
struct TransducerDrive {
  float amplitude;
  float phase;
};
using Drive = std::vector<TransducerDrive>;  ///< in layout order

struct DriveOptions {
  Weighting weighting = Weighting::distance;
  Constraint constraint = Constraint::normalise;
  Medium medium;
};

/// Whether a focus can be driven: finite, its coordinates within 100 m. Others are left out of their slot.
bool drivable(const SlotFocus& focus);

/// The focus' gain as it is used: within 0..1, NaN being 0.
float gain_of(const SlotFocus& focus);

/// What drive_for works in. Kept from call to call it makes drive_for allocate nothing once it has grown.
struct DriveScratch {
  struct Source {
    Vec3 position;
    double reach;  ///< distance of the farthest transducer
    double gain;   ///< 0..1
  };
  std::vector<Source> sources;
  std::vector<std::complex<double>> sums;  ///< one per transducer
};

/// The twin of DrivesPass, in double precision: the drive of one slot into `out`, one entry per transducer. No focus
/// (or none that is drivable): all zero. Gains outside 0..1 are clamped, NaN is 0. A transducer at the very focus has
/// phase 0.
void drive_for(const Layout& layout, std::span<const SlotFocus> foci, const DriveOptions& options,
               std::span<TransducerDrive> out, DriveScratch& scratch);
/// The same for callers that need few drives: they allocate on every call.
void drive_for(const Layout& layout, std::span<const SlotFocus> foci, const DriveOptions& options,
               std::span<TransducerDrive> out);
Drive drive_for(const Layout& layout, std::span<const SlotFocus> foci, const DriveOptions& options = {});

}  // namespace palpa::array
