// Lowers the loudest transducers of a drive without changing its sound at foci and nulls, so that the whole drive may
// be played louder: alternating projections.
//
//   x <- x limited to peak_part of its largest magnitude, phases kept
//   x <- the nearest drive with the same complex pressures at the foci, and silent at the nulls
//
// Where the foci's drives meet in phase, a transducer is several times as loud as most of the others.
#pragma once

#include <complex>
#include <cstdint>
#include <vector>

#include "array/field/split_rows.hpp"

namespace palpa::array {

inline constexpr std::uint32_t peak_steps = 4;
inline constexpr double peak_part = 0.8;

/// Keeps its storage from call to call.
struct PeakScratch {
  SplitRows apart;  ///< G of the foci without the part that the nulls' rows explain
  SplitRows next;
  std::vector<std::complex<double>> kept, missing, products, system;
};

/// `foci`: G. `nulls`: Q (nulls.hpp); only its first `null_rows` rows are used. `drive` has one row, which is silent at
/// these nulls. Ends early if a step makes it no lower. Returns the largest magnitude.
double lower_peaks(const SplitRows& foci, const SplitRows& nulls, std::size_t null_rows, SplitRows& drive,
                   PeakScratch& scratch);

/// The largest magnitude of a row.
double largest_of(const SplitRows& rows, std::size_t row);

}  // namespace palpa::array
