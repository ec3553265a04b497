// The time spectrum of the radiation pressure at a point of the skin.
//
// The pressure around one focus comes from a field, in free air or on a finger (focus_field.hpp), or is a Gaussian if
// there is no field. It is proportional to the square of the voice's gain. Foci that sound together add their
// pressures. While a schedule plays, the pressure at a skin point is piecewise constant and repeats after T = N dwell
// for N foci, so its spectrum is the lines m / T:
//
//   p(t) = mean + sum over m of A_m cos(2 pi m t / T + phase_m),  A_m e^{i phase_m} = 2 c_m sinc(m / N)
//   c_m  = 1/N sum over k of p_k e^{-2 pi i m (k + 1/2) / N},     sinc(x) = sin(pi x) / (pi x)
//
// Here p_k is the pressure during the k-th dwell. This is the exact Fourier series of p. The sinc is the effect of
// holding a value for a dwell. `Line::hold` gives it, for comparison with figures that leave it out. Modulated foci
// that stand still give the modulation's lines and their images about multiples of 1 / slot, also exactly.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "acoustics/field/focus_field.hpp"
#include "array/schedule.hpp"
#include "base/math.hpp"

namespace palpa::acoustics {

struct SpectrumOptions {
  const FocusField* field = nullptr;  ///< null: a Gaussian spot
  /// Full width of the spot at half its height. The default is what a surrounding array reaches at 40 kHz (0.443
  /// lambda).
  double fwhm_m = 3.8e-3;
  double highest_hz = 1000;  ///< highest listed line; skin feels little beyond
};

struct Line {
  double frequency_hz = 0;
  double amplitude = 0;  ///< A_m / mean at the spectrum's skin point
  double phase_rad = 0;  ///< of the cosine at the start of slot 0, in (-pi, pi]
  double around = 0;     ///< A_m / mean around the perimeter: root mean square over its points, divided by their mean
  double hold = 1;       ///< |sinc|: the factor in `amplitude` and `around` that comes from the hold of each slot
};

struct Spectrum {
  Vec3 skin{};          ///< metres: the point of `amplitude` and `phase_rad`
  double period_s = 0;  ///< the lines' greatest common period; 0: none (nothing changes, or periods do not match)
  std::vector<Line> lines;
  /// Variance over time around the perimeter, divided by the square of the mean: the sum of around^2 / 2 over all
  /// lines, including those beyond highest_hz.
  double variance = 0;
  FocusKind field{};  ///< how foci were modelled
};

/// The spectrum that `voice` causes on the skin, in slots of `slot_s`. The skin point is the voice's first focus. The
/// perimeter is the closed polygon through its foci, with eight points to a side or as many as its field needs. If the
/// voice requests a pressure, each focus has that pressure in an array's field (AskedField). Throws bad_usage for a
/// schedule that does not repeat within 1024 slots, such as a dwell of 1.2345 ms in slots of 1 ms.
Spectrum spectrum_of(const array::Voice& voice, double slot_s, const SpectrumOptions& options = {});

/// The same spectrum for N foci spread evenly on a closed curve. Only the curve's length is known, so spots are
/// Gaussian. Distances are taken along the curve. `phase_rad` is that at the first focus, `skin` is the origin.
struct Ring {
  double perimeter_m = 0;
  std::uint32_t foci = 10;
  std::uint32_t stride = 3;  ///< coprime to the foci
  double dwell_s = 1.5e-3;
};
Spectrum spectrum_of(const Ring& ring, const SpectrumOptions& options = {});

}  // namespace palpa::acoustics
