// A drive as a file: index,x,y,z,nx,ny,nz,amplitude,phase of every transducer in layout order, metres and radians.
#pragma once

#include <algorithm>
#include <filesystem>
#include <numbers>
#include <optional>
#include <span>
#include <string>

#include "array/layouts/layout.hpp"
#include "array/transducer_drive.hpp"

namespace palpa::setup {

/// The text of such a file. `layout` must be in the frame in which the positions are written.
std::string drive_csv(const array::Layout& layout, std::span<const array::TransducerDrive> drive);

/// Amplitudes up to 1 + this are 1: what rounding makes of the magnitude of a unit phasor, in single precision too.
inline constexpr double amplitude_rounding = 1e-6;
/// The amplitude that a drive from outside has, 0..1; nullopt if the number is none.
inline std::optional<float> as_given_amplitude(double number) {
  if (!(number >= 0 && number <= 1 + amplitude_rounding)) return std::nullopt;
  return static_cast<float>(std::min(number, 1.0));
}

/// Reads it back for that layout. Throws bad_input naming the line for a missing or malformed file, an amplitude
/// outside 0..1 (as_given_amplitude), or a phase that is not a number. Throws bad_input naming the difference if it is
/// the drive of another layout: the number of transducers differs, or the position or direction of one differs by more
/// than `drive_tolerance`.
array::Drive load_drive(const std::filesystem::path& file, const array::Layout& layout);
/// A million turns: beyond it, single precision has no digits left for the part of a turn that counts.
inline constexpr double most_phase_rad = 2e6 * std::numbers::pi;
inline constexpr double drive_tolerance = 1e-5;  ///< in metres, and in components of a unit vector

}  // namespace palpa::setup
