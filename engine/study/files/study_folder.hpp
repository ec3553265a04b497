// A study as a folder: sub-1, sub-2, ... with the participants' logs in sub-N/beh.
#pragma once

#include <span>
#include <string>

#include "study/files/trial.hpp"

namespace palpa::study {

/// The end of the name of the file that stays of a participant who withdrew, in the participant's folder.
inline constexpr const char* tombstone_end = "_withdrawn.json";

/// Reads one or several folders as one study. Files and rows that cannot be used are left out, and Study::left_out has
/// a line about each. Throws bad_input if a folder has no participants, two participants have the same number, nothing
/// is left that can be analysed, and for more participants, methods or shapes than the limits in trial.hpp.
Study read_study(std::span<const std::string> folders);

}  // namespace palpa::study
