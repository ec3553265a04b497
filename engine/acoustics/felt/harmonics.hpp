// The angular harmonics of a ring of foci: what its spectra have in common, whatever the order and the dwell.
//
// With N foci, stride s and dwell d the line m / (N d) carries the harmonic n with s n = m (mod N): around the ring,
// the pressure that a skin point has from focus j is a function of j, and the lines are its Fourier series in the order
// in which the foci play. So a table of N powers, once made, says what skin feels of every stride and dwell.
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
  /// Of no foci: nothing is felt.
  Harmonics() = default;
  /// Of 1 to most_ring_foci Gaussian spots on a closed curve of that length, a mean over places on it: what
  /// spectrum_of(Ring) has. Allocates nothing.
  Harmonics(double perimeter_m, std::uint32_t foci, double fwhm_m);
  /// Of these powers, a mean over places; powers[0] is that of the mean.
  explicit Harmonics(std::span<const double> powers);

  std::uint32_t foci() const { return foci_; }
  /// Of lines up to `highest_hz`. The stride is coprime to the foci.
  Felt felt(std::uint32_t stride, double dwell_s, double highest_hz) const;

 private:
  void set_variance();

  std::uint32_t foci_ = 0;
  std::array<double, most_ring_foci> power_{};
  double variance_ = 0;
};

/// What foci anywhere on a closed path give anywhere on it, as a field (focus_field.hpp) has it there: one table for
/// rings of any number of foci.
///
/// The pressure that a focus at u gives at a place v, u counted 0 to 1 around the path, is looked at on a grid as fine
/// as the field needs and turned into a Fourier series in u, with the terms k_b(v) e^{2 pi i b u}. N foci spread evenly
/// in u have the harmonics n with the powers |sum over b = n (mod N) of k_b(v)|^2, a mean over the path's length.
class PathField {
 public:
  /// `foci`, three at least, at the corners of the path. Its sides count alike in u, however long: as sectors do.
  /// If `give_up` becomes true meanwhile nothing is known and nothing felt.
  PathField(const FocusField& field, std::span<const Vec3> foci, const std::atomic<bool>* give_up = nullptr);

  /// Of 1 to most_ring_foci foci; of as many as the path has corners, of these themselves.
  Harmonics harmonics(std::uint32_t foci) const;

 private:
  std::size_t places_ = 0;
  std::vector<double> weights_;              ///< of each place
  std::vector<std::complex<double>> terms_;  ///< k_b(v) at [v * places + b], b modulo places
};

}  // namespace palpa::acoustics
