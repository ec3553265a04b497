// A drive as a file: index,x,y,z,nx,ny,nz,amplitude,phase of every transducer in layout order, metres and radians.
#pragma once

#include <filesystem>
#include <numbers>
#include <span>
#include <string>

#include "array/layouts/layout.hpp"
#include "array/transducer_drive.hpp"

namespace palpa::setup {

/// The text of such a file. `layout` must be in the frame in which the positions are written.
std::string drive_csv(const array::Layout& layout, std::span<const array::TransducerDrive> drive);

/// Reads it back for that layout. Throws bad_input naming the line for a missing or malformed file, an amplitude
/// outside 0..1, or a phase that is not a number. Throws bad_input naming the difference if it is the drive of another
/// layout: the number of transducers differs, or the position or direction of one differs by more than
/// `drive_tolerance`.
array::Drive load_drive(const std::filesystem::path& file, const array::Layout& layout);
/// A million turns: beyond it, single precision has no digits left for the part of a turn that counts.
inline constexpr double most_phase_rad = 2e6 * std::numbers::pi;
inline constexpr double drive_tolerance = 1e-5;  ///< in metres, and in components of a unit vector

}  // namespace palpa::setup
