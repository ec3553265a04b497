// What skin feels in time: the spectrum of the radiation pressure at a point of the skin.
//
// The pressure of one focus is what a field has around it, in free air or on a finger (focus_field.hpp), or, where
// there is none, taken as a Gaussian; it goes with the square of the voice's gain. Foci that sound together add their
// pressures. While a schedule plays, the pressure at a skin point is then piecewise constant and repeats after T = N
// dwell for N foci, so its spectrum is the lines m / T:
//
//   p(t) = mean + sum over m of A_m cos(2 pi m t / T + phase_m),  A_m e^{i phase_m} = 2 c_m sinc(m / N)
//   c_m  = 1/N sum over k of p_k e^{-2 pi i m (k + 1/2) / N},     sinc(x) = sin(pi x) / (pi x)
//
// with p_k the pressure during the k-th dwell: its Fourier series, exact. The sinc is what holding a value for a dwell
// does to it; `Line::hold` gives it, for comparison with figures that leave it out. Foci that stand still
// and are modulated give the modulation's lines and their images about multiples of 1 / slot, exact as well.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "acoustics/field/focus_field.hpp"
#include "array/schedule.hpp"
#include "base/math.hpp"

namespace palpa::acoustics {

struct SpectrumOptions {
  const FocusField* field = nullptr;  ///< nothing: a Gaussian spot
  /// Of the spot: at half its height it is so wide. What an array all around reaches at 40 kHz (0.443 lambda).
  double fwhm_m = 3.8e-3;
  double highest_hz = 1000;  ///< lines up to there are listed; skin feels little beyond
};

struct Line {
  double frequency_hz = 0;
  double amplitude = 0;  ///< A_m / mean at the spectrum's skin point
  double phase_rad = 0;  ///< of the cosine at the beginning of slot 0, in (-pi, pi]
  double around = 0;     ///< A_m / mean around the perimeter: root mean square over its points, by the mean over them
  double hold = 1;       ///< |sinc|: what the hold of each slot has made of `amplitude` and `around`
};

struct Spectrum {
  Vec3 skin{};          ///< metres: where `amplitude` and `phase_rad` are taken
  double period_s = 0;  ///< the lines' greatest common period; 0: none (nothing changes, or periods do not match)
  std::vector<Line> lines;
  /// Variance over time around the perimeter, by the square of the mean: the sum of around^2 / 2 over all lines, those
  /// beyond highest_hz too.
  double variance = 0;
  FocusKind field{};  ///< what a focus was
};

/// The spectrum of what `voice` makes the skin feel; slots of `slot_s`. The skin point is the voice's first focus; the
/// perimeter is the closed polygon through its foci, eight points to a side or as many as its field
/// needs. Where the voice asks for a pressure, each focus has that in an array's field (AskedField). Throws bad_usage
/// for a schedule that does not repeat within 1024 slots, such as a dwell of 1.2345 ms in slots of 1 ms.
Spectrum spectrum_of(const array::Voice& voice, double slot_s, const SpectrumOptions& options = {});

/// The same spectrum for N foci spread evenly on a closed curve of which only the length is known, so of Gaussian
/// spots; distances are taken along the curve. `phase_rad` is that at the first focus, `skin` the origin.
struct Ring {
  double perimeter_m = 0;
  std::uint32_t foci = 10;
  std::uint32_t stride = 3;  ///< coprime to the foci
  double dwell_s = 1.5e-3;
};
Spectrum spectrum_of(const Ring& ring, const SpectrumOptions& options = {});

}  // namespace palpa::acoustics
