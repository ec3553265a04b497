// Nulls as options: places where the sound of the foci is to be zero (array/nulls/nulls.hpp).
#pragma once

#include <span>
#include <string>
#include <vector>

#include "array/drive_options.hpp"
#include "array/layouts/layout.hpp"
#include "array/transducer_drive.hpp"
#include "setup/options/options.hpp"

namespace palpa::setup {

/// Adds --null. `frame` says in which frame its places are: "the layout's own frame".
void add_null_option(const line::Group& group, FocusingOptions& options, const std::string& frame);

/// Sets DriveOptions::nulls for the layout as posed, unless no nulls are given. Throws bad_usage, naming the text, for
/// one that is no null, at a transducer, or where the array hardly sounds (array/plausible.hpp); for too many; and
/// without transducers.
void prepare_nulls(const FocusingOptions& group, const array::Layout& layout, array::DriveOptions& options);

/// How messages name a focus: by its number, or by its place, in mm.
enum class FocusNames { numbers, places };

/// The null and the focus that the array tells apart least.
struct Crowding {
  double part = 0;       ///< of the sound that they share (array/resolution.hpp)
  std::string line{};    ///< says so; empty if the array resolves them
  std::string within{};  ///< a line about a focus within a null; empty if there is none
};
Crowding crowding_of(const array::Layout& layout, std::span<const array::SlotFocus> foci,
                     const array::DriveOptions& options, FocusNames names);

/// Before a drive is made: throws bad_usage for a null at a focus and for a focus within one, and warns of one that the
/// array does not resolve from a focus.
void check_nulls(const array::Layout& layout, std::span<const array::SlotFocus> foci,
                 const array::DriveOptions& options);

/// A line about a link to boards of the layout that round amplitudes so coarsely that nulls are less than 40 dB below
/// the foci; empty otherwise. `gain`: the ceiling times the least gain of a solid.
std::string coarse_boards_line(const std::string& link, const array::Layout& layout, array::Constraint constraint,
                               double gain);

/// The sound of a drive at one of its nulls.
struct SilentPlace {
  array::Null null;
  double loudest_pa = 0;  ///< within its radius, peak
  double depth_db = 0;    ///< of that, relative to the weakest focus
};
/// What nulls made of a drive.
struct NullReport {
  std::vector<SilentPlace> places;
  double kept = 1;      ///< pressure of the focus that lost most, relative to the same drive without nulls
  std::string quiet{};  ///< a line if that is less than half
  std::string loud{};   ///< a line if a null is less than 40 dB below the weakest focus
};
/// "42 dB below the weakest focus", or above.
std::string beside_weakest(double depth_db, int decimals);
/// Without absorption, as in the solvers.
NullReport report_nulls(const array::Layout& layout, std::span<const array::TransducerDrive> drive,
                        std::span<const array::SlotFocus> foci, const array::DriveOptions& options,
                        FocusNames names = FocusNames::numbers);
/// Warns of what the report doubts.
void warn_of_nulls(const NullReport& report);

}  // namespace palpa::setup
