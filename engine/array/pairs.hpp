// What the solvers' twins know of the sound between each transducer and each focus of a slot.
#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "array/directivity.hpp"
#include "array/layout.hpp"
#include "array/medium.hpp"

namespace palpa::array {

/// How the amplitude of one focus spreads over the transducers: as the distance over the farthest one's, or evenly.
enum class Weighting { distance, uniform };

/// More foci in a slot than this no solver but `naive` takes.
inline constexpr std::size_t most_solved_foci = 64;

/// Factors of what each focus asks, its q_j: `plain` as if every gain were the largest, `heard` with the gains.
struct FocusWeight {
  std::complex<double> plain = 1, heard = 1;
};

/// Entry [transducer * foci + focus] of each; all in double precision but the directivity, which is looked up.
struct Pairs {
  std::size_t foci = 0, transducers = 0;
  std::vector<double> cosine, sine;  ///< of k d, the phase that the way takes
  std::vector<double> loud;          ///< D(angle) / max(d, radius) in 1/m: what of a full transducer arrives
  std::vector<double> asked;         ///< the amplitude that the focus asks of the transducer, 0..1

  /// The directivity's table and what it was made for.
  std::vector<double> table;
  Directivity kind = Directivity::omni;
  double ka = -1;

  /// What arrives at a focus of a transducer at full amplitude and phase 0.
  std::complex<double> transfer(std::size_t entry) const {
    return {loud[entry] * cosine[entry], loud[entry] * sine[entry]};
  }
  /// What a focus asks of a transducer: q_j, conjugate in phase to the transfer.
  std::complex<double> ask(std::size_t entry) const {
    return {asked[entry] * cosine[entry], -asked[entry] * sine[entry]};
  }
};

/// One focus of a slot as the twins see it.
struct FocusSource {
  Vec3 position;
  double reach;  ///< distance of the farthest transducer
  double gain;   ///< 0..1
};

/// Fills `pairs` for these foci, keeping its storage. The phase is within 1e-14 turns of what the distance says.
void fill_pairs(const Layout& layout, std::span<const FocusSource> foci, const Medium& medium, Directivity kind,
                Weighting weighting, Pairs& pairs);

}  // namespace palpa::array
