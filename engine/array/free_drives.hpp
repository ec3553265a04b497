// Drives in the free field (drive.hpp has the formulas), computed for several transducers at a time. Every processor
// gives the same bits.
#pragma once

#include <algorithm>
#include <complex>
#include <span>

#include "array/amplitudes.hpp"
#include "array/field/transfer.hpp"
#include "array/layouts/layout.hpp"
#include "array/medium.hpp"
#include "array/transducer_drive.hpp"
#include "base/math.hpp"

namespace palpa::array {

[[gnu::always_inline]] inline float as_amplitude(double amplitude) {
  return static_cast<float>(std::min(std::max(amplitude, 0.0), 1.0));
}
[[gnu::always_inline]] inline float as_phase(double radians) {
  constexpr float float_pi = 3.1415925F;  // the largest float that is not above pi; pi itself would round up
  return std::min(std::max(static_cast<float>(radians), -float_pi), float_pi);
}

/// The distance of the farthest transducer from a focus.
double farthest_distance(const Layout& layout, const Vec3& focus);

/// The paper's q_k of one focus times its gain.
void drive_focus_in_free_field(const Layout& layout, const FocusSource& source, Weighting weighting,
                               const Medium& medium, std::span<TransducerDrive> out);

/// Replaces `sums` by the sum of every q_j times its factor `heard`, for each transducer. Returns the largest magnitude
/// among these sums and those with the factors `plain`.
double sum_foci_in_free_field(const Layout& layout, std::span<const FocusSource> sources,
                              std::span<const FocusWeight> weights, Weighting weighting, const Medium& medium,
                              std::span<std::complex<double>> sums);

/// Replaces `out` by `sums` as drives: amplitudes |sum| / `largest`, at most 1, times `gain`.
void drive_sums(std::span<const std::complex<double>> sums, double largest, double gain,
                std::span<TransducerDrive> out);

}  // namespace palpa::array
