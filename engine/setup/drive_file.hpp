// A drive as a file: index,x,y,z,nx,ny,nz,amplitude,phase of every transducer in layout order, metres and radians.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "array/drive.hpp"
#include "array/layout.hpp"

namespace palpa::setup {

/// The text of such a file. `layout` in the frame that its positions are to be in.
std::string drive_csv(const array::Layout& layout, std::span<const array::TransducerDrive> drive);

/// Reads it back for that layout. Throws bad_input naming the line: no such file, an amplitude outside 0..1, a phase
/// that is no number; and, with what differs, where it is the drive of another layout: another number of transducers,
/// or one that stands or looks elsewhere by more than `drive_tolerance`.
array::Drive load_drive(const std::filesystem::path& file, const array::Layout& layout);
inline constexpr double drive_tolerance = 1e-5;  ///< metres, and of a unit vector

}  // namespace palpa::setup
