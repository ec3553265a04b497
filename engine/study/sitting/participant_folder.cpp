#include "study/sitting/participant_folder.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <optional>
#include <system_error>

#include "base/error.hpp"
#include "base/files/output_file.hpp"
#include "study/files/study_folder.hpp"
#include "study/plan/order.hpp"

namespace palpa::study {
namespace {

namespace fs = std::filesystem;

/// If there is a folder with the number, takes its path.
void find_existing(const fs::path& study, ParticipantFolder& folder) {
  std::optional<fs::path> found;
  for (const ParticipantFolder& there : participant_folders(study)) {
    if (there.number != folder.number) continue;
    if (found) {
      throw bad_input(there.path.string(), fmt::format("also has the number {}, as {} has: give each participant a "
                                                       "number of their own",
                                                       folder.number, found->string()));
    }
    found = there.path;
  }
  if (found) folder.path = *found;
}

}  // namespace

std::string ParticipantFolder::name() const {
  return path.filename().string();
}

fs::path ParticipantFolder::journal() const {
  return path / (name() + journal_end);
}

fs::path ParticipantFolder::tombstone() const {
  return path / (name() + tombstone_end);
}

fs::path ParticipantFolder::beh() const {
  return path / "beh";
}

fs::path ParticipantFolder::file(std::uint32_t run, const std::string& end) const {
  return beh() / fmt::format("{}_task-shapes_run-{:02}{}", name(), run, end);
}

bool ParticipantFolder::withdrawn() const {
  std::error_code fault;
  return fs::exists(fs::symlink_status(tombstone(), fault));
}

std::vector<ParticipantFolder> participant_folders(const fs::path& study) {
  std::vector<ParticipantFolder> folders;
  std::error_code fault;
  if (!fs::is_directory(study, fault)) return folders;
  for (const fs::path& path : entries_of(study)) {
    if (const auto number = participant_number(path.filename().string()))
      folders.push_back({.number = *number, .path = path});
  }
  std::ranges::stable_sort(folders, {}, &ParticipantFolder::number);
  return folders;
}

ParticipantFolder participant_folder(const fs::path& study, std::uint32_t number) {
  if (number == 0 || number > most_participant_number)
    throw bad_usage(fmt::format("participants have numbers from 1 to {}", most_participant_number));
  ParticipantFolder folder{.number = number, .path = study / fmt::format("sub-{:02}", number)};
  std::error_code fault;
  if (fs::exists(study, fault) && !fs::is_directory(study, fault))
    throw bad_input(study.string(), "is not a folder: give the folder of a study");
  find_existing(study, folder);
  if (const fs::file_status there = fs::symlink_status(folder.path, fault);
      fs::exists(there) && !fs::is_directory(there))
    throw bad_input(folder.path.string(), fs::is_symlink(there)
                                              ? "is a link: a participant's folder must be here itself"
                                              : "is not a folder");
  return folder;
}

void make_folders(const ParticipantFolder& folder) {
  const fs::path study = folder.path.parent_path();
  std::error_code fault;
  fs::create_directories(study, fault);
  if (fault) throw failure(fmt::format("{}: cannot be created: {}", study.string(), fault.message()));
  bool made = false;
  for (const fs::path& place : {folder.path, folder.beh()}) {
    if (!make_folder(place)) continue;
    keep_to_owner(place);
    made = true;
  }
  if (!made) return;
  for (const fs::path& place : {folder.beh(), folder.path.parent_path()})
    keep_file(place);
}

void restrict_to_owner(const ParticipantFolder& folder) {
  keep_to_owner(folder.path);
  std::error_code fault;
  for (fs::recursive_directory_iterator at(folder.path, fault), end; !fault && at != end; at.increment(fault))
    keep_to_owner(at->path());
}

void remove_leftovers(const ParticipantFolder& folder) {
  for (const fs::path& place : {folder.path, folder.beh()}) {
    std::error_code fault, kept;
    for (fs::directory_iterator at(place, fault), end; !fault && at != end; at.increment(fault)) {
      if (at->path().filename().string().starts_with(temporary_prefix)) fs::remove(at->path(), kept);
    }
  }
}

}  // namespace palpa::study
