// How loud an array is to the ear. Ultrasound is not heard, but the air demodulates changes of its power. Beside the
// beam, at the distance r:
//
//   tau da/dt + a = d(t)            a transducer's output for its drive d, complex; tau = Q / (pi f)
//   P = sum |a|^2 p1^2 pi D2 / (rho c)     the radiated power; p1: peak pressure at 1 m, times 1 m
//   p = beta / (2 pi c^2 r) dP/dt   what is heard, with beta = 1.2
//
// D2 = 0.291 is the mean of a transducer's squared directivity over the half space. The formula for p follows from
// Westervelt's equation for a beam that is heard from the side. Q is 20 to 40 for the transducers of known arrays. What
// is not in it: the hand, the room, steepening, the electronics, other modes of transducers. Absolute levels are sure
// to about 10 dB, differences between two settings to 3 to 6 dB.
#pragma once

#include <complex>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "acoustics/air.hpp"
#include "array/layouts/changes.hpp"
#include "array/transducer_drive.hpp"
#include "base/files/json_writer.hpp"

namespace palpa::acoustics {

/// Drives that repeat for ever.
struct PlayedDrives {
  std::span<const array::TransducerDrive> drives;  ///< slot after slot
  std::size_t transducers = 0;                     ///< of each slot
  double slot_s = 1.5e-3;                          ///< at least one period
  array::Changes changes;
};

struct EarOptions {
  Air air;  ///< its frequency is the carrier's
  double source_level_pa_m = 4.386;
  double distance_m = 0.72;  ///< from the array: as far as the ears of a study's participant usually are
};

/// The quality factors of transducers; --audible has the range of both.
inline constexpr double least_q = 20, most_q = 40;

/// After this part of a slot, nothing changes in it, and nothing is heard before the next one.
inline constexpr double longest_change_s = 10e-3;

/// The radiated power after each period of the carrier, watts, once it repeats; of each slot the first longest_change_s
/// at most.
std::vector<double> radiated_power(const PlayedDrives& played, double q, const EarOptions& options);

/// The Fourier lines of the sound, from the first on: pascals, complex, so that
/// p(t) = 2 Re sum lines[n - 1] e^{-2 pi i n t / period}. Up to half the carrier's frequency. A period is `slots` parts
/// of the same length. Where slots are longer than longest_change_s, it has their beginnings alone, and a pause of
/// `pause_s` follows on each.
struct HeardSound {
  double period_s = 0;
  std::vector<std::complex<double>> lines;
  std::size_t slots = 1;
  double pause_s = 0;
};
HeardSound heard_sound(const PlayedDrives& played, double q, const EarOptions& options);

/// The A-weighted level, dB; -infinity if the power is constant.
double a_weighted_db(const HeardSound& sound);
/// The A-weighting of a tone, dB; 0 at 1 kHz.
double a_weighting_db(double hz);

/// A range of levels.
struct EarLevel {
  double low_dba = 0, high_dba = 0;
};
/// For Q from least_q to most_q.
EarLevel ear_level(const PlayedDrives& played, const EarOptions& options);
/// Adds "audible_dba": the range; null where the power is constant.
void write_level(const EarLevel& level, JsonWriter& json);
/// "41 to 44 dB(A)"; nothing below 0 dB(A) is heard, so that it says "less than 0 dB(A)".
std::string to_text(const EarLevel& level);

/// A full-scale sine of a WAV file has this level, unless it is changed.
inline constexpr double usual_full_scale_db = 81;
/// A WAV file of 3 s, 48 kHz, 16 bits, mono, without what is above 16 kHz. `peak` gets the largest sample, where 1 is
/// full scale; samples beyond it are cut.
std::string to_wav(const HeardSound& sound, double full_scale_db, double& peak);

}  // namespace palpa::acoustics
