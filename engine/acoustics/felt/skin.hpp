// What skin makes of a spectrum of pressure: two kinds of afferents feel it, in two bands.
//
// *Vibration* is felt by Pacinian afferents (PC, FA II), some 40 to 400 Hz, *flutter* by Meissner's (RA, FA I), some 5
// to 50 Hz; they are two sensations, of a buzz that spreads and of a throbbing at one place (Mountcastle, Talbot,
// Darian-Smith and Kornhuber 1967). Johansson, Landstroem and Lundstroem (1982) found RA units easiest to excite from 8
// to 64 Hz and PC units above 64 Hz. Good for comparing schedules, not for predicting whether somebody feels one:
// thresholds are of displacement and differ with person, place and contact; how skin turns pressure into displacement
// is not modelled.
#pragma once

#include <cstddef>

#include "acoustics/felt/spectrum.hpp"

namespace palpa::acoustics {

/// How sensitive Pacinian afferents are to a vibration of `hz`, by how sensitive they are at their best, 200 Hz; 0 at
/// 0.
///
/// A stand-in for the curve of their channel: 2 / ((200/hz)^2 + (hz/200)^2). Its threshold falls by 12 dB per
/// octave towards the best frequency, as measured from 40 Hz upwards (Gescheider and Verrillo 1979), is within 1.5 dB
/// of its least from 151 to 265 Hz, where measured thresholds are lowest (150 to 200 Hz, Brisben et al. 1999; about 250
/// Hz, Gescheider and Verrillo), and rises as steeply above.
double vibration_sensitivity(double hz);
inline constexpr double best_felt_hz = 200;

/// The same of RA afferents, by how sensitive they are in their own band: 1 within it, 3 dB less at its ends, 5 and
/// 50 Hz, and 12 dB per octave less outside of it: 1 / sqrt((1 + (5/hz)^4) (1 + (hz/50)^4)). Thresholds below 40 Hz are
/// about the same at all frequencies (Verrillo 1963).
double flutter_sensitivity(double hz);

/// What is felt of a vibration, as shares of its energy: the sum of (sensitivity around)^2 / 2 over the lines, by the
/// variance. A sine of 200 Hz is all vibration, one of 20 Hz all but all flutter.
struct Felt {
  double vibration = 0, flutter = 0;
};

/// What flutter weighs against vibration, in `balance`, where both have the same energy and each is in its own band.
///
/// Measurements leave room between two ends. By the displacement that is just detected RA afferents take over below
/// 64 Hz (Johansson et al.), so that at their best they are what the PC curve is there: 0.20, or 0.04 of the energy.
/// But a focus that moves over the skin, as these do, is clearly felt at low frequencies, too: lateral modulation, more
/// than amplitude modulation from 10 to 200 Hz (Takahashi, Hasegawa and Shinoda 2020). So as much as vibration: whoever
/// asks for vibration should not get flutter that might be as strong.
inline constexpr double flutter_weight = 1;

/// What a tuning makes large: vibration, less the flutter beside it.
double balance(const Felt& felt);

/// A line's amplitude around the perimeter, weighted by how vibration is felt at its frequency.
double felt_as_vibration(const Line& line);
/// Nothing of either where nothing changes.
Felt felt(const Spectrum& spectrum);
/// The share of the energy in lines from `low_hz` to `high_hz`.
double band_share(const Spectrum& spectrum, double low_hz, double high_hz);
/// Index of the line that is felt most as vibration, or lines.size() if there is none.
std::size_t strongest_felt(const Spectrum& spectrum);

}  // namespace palpa::acoustics
