// From foci that are asked for to the schedule of one slot, and to its drive on the host: what `palpa drive` and
// `palpa field` share.
#pragma once

#include <complex>
#include <span>
#include <string>
#include <vector>

#include "array/drive.hpp"
#include "array/layout.hpp"
#include "array/schedule.hpp"
#include "base/math.hpp"

namespace palpa::setup {

/// What --focus says in --help.
inline constexpr const char* focus_help =
    "in the layout's own frame; A above 0, at most 1: how loud it is to be; again for several foci at once";

/// A focus that is asked for.
struct AskedFocus {
  Vec3 position{0};  ///< metres, in the layout's own frame
  float gain = 1;    ///< above 0, at most 1: how loud it is to be
};

/// One voice per focus, all in slot 0. Throws bad_usage, naming the focus by its number from 1, for a gain outside of
/// its range, for a focus farther than 100 m from the array and for one where a transducer stands. Warns of a focus
/// that is worth little (array/usual.hpp).
array::Schedule schedule_of(std::span<const AskedFocus> foci, const array::Layout& layout);
/// The same of texts "x,y,z" or "x,y,z,gain" as --focus takes them, lengths with or without a unit; messages name the
/// option and the text.
array::Schedule schedule_of(std::span<const std::string> foci, const array::Layout& layout);

/// The same check of one focus; `what` names it.
void check_focus(const array::Layout& layout, const array::SlotFocus& focus, const std::string& what);

/// Factors of the foci of slot 0, whose voices are to have the pressures that they ask for; empty where none asks.
/// Warns of what the array does not give. `touch` is the file that the voices are from; empty: from --focus.
std::vector<std::complex<double>> factors_for(const array::Layout& layout, array::Schedule& schedule,
                                              const array::DriveOptions& options, const std::string& touch = {});

/// The drive of these foci on the host. `factors` are empty where no pressure is asked for.
array::Drive drive_on_cpu(const array::Layout& layout, std::span<const array::SlotFocus> foci,
                          std::span<const std::complex<double>> factors, const array::DriveOptions& options);

}  // namespace palpa::setup
