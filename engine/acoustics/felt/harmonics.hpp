// The angular harmonics of a ring of foci: the part of its spectra that is the same for any order and dwell.
//
// With N foci, stride s and dwell d, the line m / (N d) carries the harmonic n with s n = m (mod N). Around the ring,
// the pressure that focus j causes at a skin point is a function of j, and the lines are its Fourier series in the
// order in which the foci play. A table of N powers, made once, therefore gives the felt intensity for every stride and
// dwell.
#pragma once

#include <array>
#include <atomic>
#include <complex>
#include <cstdint>
#include <span>
#include <vector>

#include "acoustics/felt/skin.hpp"
#include "acoustics/field/focus_field.hpp"

namespace palpa::acoustics {

inline constexpr std::uint32_t most_ring_foci = 64;

class Harmonics {
 public:
  /// Without foci: nothing is felt.
  Harmonics() = default;
  /// Of 1 to most_ring_foci Gaussian spots on a closed curve of that length, averaged over places on it: the same as in
  /// spectrum_of(Ring). Allocates nothing.
  Harmonics(double perimeter_m, std::uint32_t foci, double fwhm_m);
  /// From these powers, averaged over places; powers[0] is that of the mean.
  explicit Harmonics(std::span<const double> powers);

  std::uint32_t foci() const { return foci_; }
  /// For lines up to `highest_hz`. The stride is coprime to the number of foci.
  Felt felt(std::uint32_t stride, double dwell_s, double highest_hz) const;

 private:
  void set_variance();

  std::uint32_t foci_ = 0;
  std::array<double, most_ring_foci> power_{};
  double variance_ = 0;
};

/// The effect of foci anywhere on a closed path at any place on it, according to a field (focus_field.hpp): one table
/// for rings with any number of foci.
///
/// The pressure at a place v from a focus at u, where u runs from 0 to 1 around the path, is sampled on a grid as fine
/// as the field needs. It is turned into a Fourier series in u, with the terms k_b(v) e^{2 pi i b u}. N foci spread
/// evenly in u have the harmonics n with the powers |sum over b = n (mod N) of k_b(v)|^2, averaged over the path's
/// length.
class PathField {
 public:
  /// `foci` (at least three) are the corners of the path. All its sides have the same length in u, like sectors. If
  /// `give_up` becomes true meanwhile, the table is empty and nothing is felt.
  PathField(const FocusField& field, std::span<const Vec3> foci, const std::atomic<bool>* give_up = nullptr);

  /// For 1 to most_ring_foci foci; if their number is the number of the path's corners, for exactly these foci.
  Harmonics harmonics(std::uint32_t foci) const;

 private:
  std::size_t places_ = 0;
  std::vector<double> weights_;              ///< of each place
  std::vector<std::complex<double>> terms_;  ///< k_b(v) at [v * places + b], b modulo places
};

}  // namespace palpa::acoustics
