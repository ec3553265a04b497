// The starts of a search (search.hpp), eight at a time in single precision, one in each lane of a vector.
#pragma once

#include <complex>
#include <cstdint>
#include <span>
#include <vector>

#include "array/field/transfer.hpp"

namespace palpa::array {

/// G and B of a part of the transducers, entry [transducer * foci + focus].
struct SinglePart {
  struct Entry {
    float g_re, g_im, b_re, b_im;
  };
  std::size_t foci = 0, transducers = 0;
  std::vector<Entry> entries;
};
/// Replaces `part`, keeping its storage.
void take_single(const Columns& columns, SinglePart& part);

inline constexpr std::size_t starts_together = 8;
inline constexpr std::size_t most_searched_foci = 32;

/// Weighted Gerchberg-Saxton with all amplitudes at 1, for `steps` steps, from up to starts_together starts, factors
/// [start * foci + focus]. Replaces them by the factors of each start's loudest moment, and fills `merits` with the
/// weakest focus then, relative to its claim. Foci whose claim is 0 are ignored. The same bytes for any processor.
void run_starts(const SinglePart& part, std::span<const double> claims, std::uint32_t steps,
                std::span<std::complex<double>> starts, std::span<double> merits);

}  // namespace palpa::array
