// From the foci on a command line to a drive: what the commands that take --focus share.
#pragma once

#include <complex>
#include <span>
#include <string>
#include <vector>

#include "array/drive.hpp"
#include "array/layout.hpp"
#include "array/schedule.hpp"

namespace palpa::cli {

/// What --focus is told in --help.
inline constexpr const char* focus_help =
    "in the layout's own frame; A above 0, at most 1: how loud it is to be; again for several foci at once";

/// One voice per text "x,y,z" or "x,y,z,a". Throws bad_usage for what is no focus or cannot be driven, and warns of
/// what is worth little.
array::Schedule schedule_of(const std::vector<std::string>& foci, const array::Layout& layout);

/// The same check of one focus; `what` names it.
void check_focus(const array::Layout& layout, const array::SlotFocus& focus, const std::string& what);

/// Factors of the foci of slot 0, whose voices are to have the pressures that they ask for; empty where none asks.
/// Warns of what the array does not give. `touch` is the file that the voices are from; empty: from --focus.
std::vector<std::complex<double>> factors_for(const array::Layout& layout, array::Schedule& schedule,
                                              const array::DriveOptions& options, const std::string& touch = {});

/// The drive of these foci on the host. `factors` are empty where no pressure is asked for.
array::Drive drive_on_cpu(const array::Layout& layout, const std::vector<array::SlotFocus>& foci,
                          std::span<const std::complex<double>> factors, const array::DriveOptions& options);

}  // namespace palpa::cli
