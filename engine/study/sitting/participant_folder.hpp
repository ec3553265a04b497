// The folder of a participant in the folder of a study: sub-07 with the journal, and sub-07/beh with the files that are
// analysed (docs/study.md).
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace palpa::study {

struct ParticipantFolder {
  std::uint32_t number = 0;
  std::filesystem::path path;

  std::string name() const;                 ///< "sub-07", or "sub-7" if its folder has this name
  std::filesystem::path journal() const;    ///< sub-07/sub-07_journal.jsonl
  std::filesystem::path tombstone() const;  ///< sub-07/sub-07_withdrawn.json
  std::filesystem::path beh() const;
  /// beh/sub-07_task-shapes_run-02 plus `end`, such as "_events.tsv". Runs count from 1.
  std::filesystem::path file(std::uint32_t run, const std::string& end) const;
  bool withdrawn() const;
};

/// The participant's folder in the study's: the one that has the number, such as sub-7, or sub-07 if there is none.
/// Throws bad_usage for a number that is not 1 to most_participant_number, bad_input if the study's folder is a file,
/// the participant's folder is a link, or two folders have the same number, such as sub-7 and sub-07.
ParticipantFolder participant_folder(const std::filesystem::path& study, std::uint32_t number);

/// All participants' folders in the study's, by number; none if there is no such folder. Throws bad_input if it cannot
/// be read.
std::vector<ParticipantFolder> participant_folders(const std::filesystem::path& study);

/// Creates what is missing of it, the participant's folders for their owner only. Throws failure().
void make_folders(const ParticipantFolder& folder);

/// Lets only their owner read what is in it. Copied files, and those of an older palpa, may have other modes.
void restrict_to_owner(const ParticipantFolder& folder);

/// Removes files with a temporary name from it: a program that is killed while it replaces a file may leave one. Call
/// with the journal locked.
void remove_leftovers(const ParticipantFolder& folder);

}  // namespace palpa::study
