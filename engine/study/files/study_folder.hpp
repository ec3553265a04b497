// A study as a folder: sub-1, sub-2, ... with the participants' logs in sub-N/beh.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "study/files/trial.hpp"

namespace palpa::study {

/// The end of the name of the file that stays of a participant who withdrew, in the participant's folder.
inline constexpr const char* tombstone_end = "_withdrawn.json";
/// The end of the name of the journal of a participant's sitting, in the participant's folder.
inline constexpr const char* journal_end = "_journal.jsonl";

/// The number in "sub-7"; empty for another name.
std::optional<std::uint32_t> participant_number(std::string_view name);
/// All files and folders in a folder, sorted. Throws bad_input if it cannot be read.
std::vector<std::filesystem::path> entries_of(const std::filesystem::path& folder);

/// Reads one or several folders as one study. Files and rows that cannot be used are left out, and Study::left_out has
/// a line about each, and about each journal that has answers that are in no log, or that is not finished. Throws
/// bad_input if a folder has no participants, two participants have the same number, nothing is left that can be
/// analysed, and for more participants, methods or shapes than the limits in trial.hpp.
Study read_study(std::span<const std::string> folders);

}  // namespace palpa::study
