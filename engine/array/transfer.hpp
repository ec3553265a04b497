// What the solvers know of the sound between transducers and foci: the columns of G and B, and the matrix R = G B.
// Which sound it is, that of the free field or that around a finger, is the Transfer's business alone.
#pragma once

#include <complex>
#include <cstddef>
#include <span>
#include <vector>

#include "base/math.hpp"
#include "base/words.hpp"

namespace palpa::array {

/// How the amplitude of one focus spreads over the transducers: as the distance over the farthest one's, or evenly.
enum class Weighting { distance, uniform };
inline constexpr Word<Weighting> weighting_words[] = {{"distance", Weighting::distance},
                                                      {"uniform", Weighting::uniform}};

/// More foci in a slot than this no solver but `naive` takes.
inline constexpr std::size_t most_solved_foci = 64;

/// Factors of what each focus asks, its q_j: `plain` as if every gain were the largest, `heard` with the gains.
struct FocusWeight {
  std::complex<double> plain = 1, heard = 1;
};

/// One focus of a slot.
struct FocusSource {
  Vec3 position;
  double reach;  ///< distance of the farthest transducer
  double gain;   ///< 0..1
};

/// The columns of a slot's foci, entry [transducer * foci + focus] of each.
struct Columns {
  std::size_t foci = 0, transducers = 0;
  std::vector<double> cosine, sine;  ///< of the phase of what arrives
  std::vector<double> loud;          ///< what of a full transducer arrives, in 1/m (times the source level: Pa)
  std::vector<double> asked;         ///< the amplitude that the focus asks of the transducer, 0..1

  /// G: what arrives at a focus of a transducer at full amplitude and phase 0.
  std::complex<double> transfer(std::size_t entry) const {
    return {loud[entry] * cosine[entry], loud[entry] * sine[entry]};
  }
  /// B: what a focus asks of a transducer, q_j, conjugate in phase to the transfer.
  std::complex<double> ask(std::size_t entry) const {
    return {asked[entry] * cosine[entry], -asked[entry] * sine[entry]};
  }
};

/// R = G B: what arrives at focus `row` of what focus `column` asks. Entry [column * foci + row].
struct FocusMatrix {
  std::size_t foci = 0;
  std::vector<double> re, im;

  std::complex<double> at(std::size_t row, std::size_t column) const {
    return {re[column * foci + row], im[column * foci + row]};
  }
  /// What a focus gives at its own place alone.
  double alone(std::size_t focus) const { return re[focus * foci + focus]; }
};

/// Fills `matrix` from all columns, keeping its storage.
void multiply(const Columns& columns, FocusMatrix& matrix);

/// Where columns come from. Twin: shaders/transfer_*.glsl.
class Transfer {
 public:
  virtual ~Transfer() = default;
  /// Replaces `columns` by those of these foci, keeping its storage.
  virtual void fill(std::span<const FocusSource> foci, Weighting weighting, Columns& columns) const = 0;
  /// The same of `count` transducers from `first` on, for whoever wants less of it at a time.
  virtual void fill(std::span<const FocusSource> foci, Weighting weighting, std::size_t first, std::size_t count,
                    Columns& columns) const = 0;
};

}  // namespace palpa::array
