// From requested foci to the schedule of one slot, and to its drive on the host. Shared by `palpa drive` and `palpa
// field`.
#pragma once

#include <complex>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "array/drive_options.hpp"
#include "array/layouts/layout.hpp"
#include "array/schedule.hpp"
#include "array/transducer_drive.hpp"
#include "base/math.hpp"

namespace palpa::setup {

/// The help text of --focus.
inline constexpr const char* focus_help =
    "focus in the layout's own frame; A is how loud it is, 0 to 1, and 1 if you leave it out; give it again for more "
    "foci at once";

/// A requested focus.
struct AskedFocus {
  Vec3 position{0};  ///< metres, in the layout's own frame
  float gain = 1;    ///< above 0, at most 1: its loudness
};

/// One voice per focus, all in slot 0. Throws bad_usage, naming the focus by its number from 1, for a gain out of
/// range, a focus farther than 100 m from the array, or a focus at a transducer. Warns of a weak focus
/// (array/plausible.hpp).
array::Schedule schedule_of(std::span<const AskedFocus> foci, const array::Layout& layout);
/// The same for texts "x,y,z" or "x,y,z,gain", as given to --focus; lengths may have a unit. Messages name the option
/// and the text.
array::Schedule schedule_of(std::span<const std::string> foci, const array::Layout& layout);

/// Throws bad_usage for a text that is no value of --focus.
void check_focus_text(const std::string& text);
/// The same check of one focus; `what` names it.
void check_focus(const array::Layout& layout, const array::SlotFocus& focus, const std::string& what);

/// Throws bad_usage unless the pressure requested at each focus is above 0 and at most array::most_pressure_pa.
void check_pressure(std::optional<double> pressure_pa);
/// Throws bad_usage unless the drive has an amplitude from 0 to 1 (as_given_amplitude) and a phase of at most a million
/// turns for each transducer of the layout, which has at least one.
void check_drive(const array::Layout& layout, std::span<const array::TransducerDrive> drive);

/// Factors for the foci of slot 0, with which the voices get their requested pressures; empty if none are requested.
/// Warns of pressures that the array does not reach. `touch` is the file of the voices; empty: they come from --focus.
std::vector<std::complex<double>> factors_for(const array::Layout& layout, array::Schedule& schedule,
                                              const array::DriveOptions& options, const std::string& touch = {});

/// The drive of these foci on the host. `factors` are empty if no pressure is requested.
array::Drive drive_on_cpu(const array::Layout& layout, std::span<const array::SlotFocus> foci,
                          std::span<const std::complex<double>> factors, const array::DriveOptions& options);

}  // namespace palpa::setup
