// The sound between transducers and foci as the solvers use it: the columns of G and B, and the matrix R = G B. Only
// the Transfer knows whether it is the free field or the field around a finger.
#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "array/amplitudes.hpp"
#include "base/math.hpp"

namespace palpa::array {

/// The maximum number of foci in a slot for all solvers except `naive`.
inline constexpr std::size_t most_solved_foci = 64;

/// Factors of each focus' q_j: `plain` as if every gain were the largest, `heard` with the gains.
struct FocusWeight {
  std::complex<double> plain = 1, heard = 1;
};

/// One focus of a slot.
struct FocusSource {
  Vec3 position;
  double farthest;  ///< distance of the farthest transducer
  double gain;      ///< 0..1
};

/// The columns of a slot's foci, entry [transducer * foci + focus] of each.
struct Columns {
  std::size_t foci = 0, transducers = 0;
  std::vector<double> cosine, sine;  ///< of the phase of the arriving pressure
  std::vector<double> loud;          ///< arriving pressure of a transducer at full amplitude, in 1/m (times the source
                                     ///< level: Pa)
  std::vector<double> asked;         ///< the amplitude of the transducer for the focus, 0..1

  /// G: the pressure at a focus from a transducer at full amplitude and phase 0.
  std::complex<double> transfer(std::size_t entry) const {
    return {loud[entry] * cosine[entry], loud[entry] * sine[entry]};
  }
  /// B: the drive q_j of a transducer for a focus, conjugate in phase to the transfer.
  std::complex<double> ask(std::size_t entry) const {
    return {asked[entry] * cosine[entry], -asked[entry] * sine[entry]};
  }
};

/// R = G B: the pressure at focus `row` from the drive for focus `column`. Entry [column * foci + row].
struct FocusMatrix {
  std::size_t foci = 0;
  std::vector<double> re, im;

  std::complex<double> at(std::size_t row, std::size_t column) const {
    return {re[column * foci + row], im[column * foci + row]};
  }
  /// The pressure of a focus alone at its own place.
  double alone(std::size_t focus) const { return re[focus * foci + focus]; }
};

/// Fills `matrix` from all columns, keeping its storage.
void multiply(const Columns& columns, FocusMatrix& matrix);

/// The source of columns. Twin: shaders/array/drive/transfer_*.glsl.
class Transfer {
 public:
  virtual ~Transfer() = default;
  /// Replaces `columns` by the columns of these foci, keeping its storage.
  virtual void fill(std::span<const FocusSource> foci, Weighting weighting, Columns& columns) const = 0;
  /// The same for `count` transducers from `first` on, to limit memory.
  virtual void fill(std::span<const FocusSource> foci, Weighting weighting, std::size_t first, std::size_t count,
                    Columns& columns) const = 0;
};

}  // namespace palpa::array
