// How skin feels a spectrum of pressure: two kinds of afferents respond in two bands.
//
// *Vibration* is felt by Pacinian afferents (PC, FA II), about 40 to 400 Hz, *flutter* by Meissner's (RA, FA I), about
// 5 to 50 Hz. They are two sensations, a buzz that spreads and a throbbing at one place (Mountcastle, Talbot,
// Darian-Smith and Kornhuber 1967). Johansson, Landstroem and Lundstroem (1982) found RA units easiest to excite from 8
// to 64 Hz and PC units above 64 Hz. This model can compare schedules, but cannot predict whether somebody feels one:
// thresholds are given as displacement and differ with person, place and contact, and how skin turns pressure into
// displacement is not modelled.
#pragma once

#include <cstddef>

#include "acoustics/felt/spectrum.hpp"

namespace palpa::acoustics {

/// The sensitivity of Pacinian afferents to a vibration of `hz`, relative to their maximum at 200 Hz; 0 at 0.
///
/// An approximation of the curve of their channel: 2 / ((200/hz)^2 + (hz/200)^2). Its threshold falls by 12 dB per
/// octave towards the best frequency, as measured from 40 Hz upwards (Gescheider and Verrillo 1979). It is within 1.5
/// dB of its minimum from 151 to 265 Hz, where measured thresholds are lowest (150 to 200 Hz, Brisben et al. 1999;
/// about 250 Hz, Gescheider and Verrillo), and rises as steeply above.
double vibration_sensitivity(double hz);
inline constexpr double best_felt_hz = 200;

/// The same for RA afferents, relative to their own band: 1 within it, 3 dB less at its ends, 5 and 50 Hz, and 12 dB
/// per octave less outside: 1 / sqrt((1 + (5/hz)^4) (1 + (hz/50)^4)). Thresholds below 40 Hz are about the same at all
/// frequencies (Verrillo 1963).
double flutter_sensitivity(double hz);

/// The felt shares of a pressure's energy: the sum of (sensitivity around)^2 / 2 over the lines, divided by the
/// variance. A sine of 200 Hz is only vibration, one of 20 Hz almost only flutter.
struct Felt {
  double vibration = 0, flutter = 0;
};

/// The weight of flutter relative to vibration in `balance`, at equal energy and each in its own band.
///
/// Measurements allow a range of values. Judged by the smallest detectable displacement, RA afferents take over below
/// 64 Hz (Johansson et al.), so their maximum equals the PC curve there: 0.20, or 0.04 of the energy. However, a focus
/// that moves over the skin, as these foci do, is also clearly felt at low frequencies: lateral modulation, more than
/// amplitude modulation from 10 to 200 Hz (Takahashi, Hasegawa and Shinoda 2020). Flutter therefore has the same weight
/// as vibration: a user who asks for vibration should not get flutter that might be as strong.
inline constexpr double flutter_weight = 1;

/// The quantity that tuning maximises: vibration minus weighted flutter.
double balance(const Felt& felt);

/// A line's amplitude around the perimeter, weighted by the sensitivity to vibration at its frequency.
double felt_as_vibration(const Line& line);
/// Both are 0 if nothing changes.
Felt felt(const Spectrum& spectrum);
/// Index of the line that is felt most strongly as vibration, or lines.size() if there is none.
std::size_t strongest_felt(const Spectrum& spectrum);

}  // namespace palpa::acoustics
