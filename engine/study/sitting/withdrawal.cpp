#include "study/sitting/withdrawal.hpp"

#include <fmt/core.h>

#include <system_error>
#include <vector>

#include "base/error.hpp"
#include "base/json_writer.hpp"
#include "base/output_file.hpp"
#include "base/outputs.hpp"
#include "study/sitting/participant_folder.hpp"

namespace palpa::study {
namespace {

namespace fs = std::filesystem;

std::string tombstone_text(std::uint32_t participant) {
  JsonWriter json;
  json.begin_object().member("Participant", participant).member("Withdrawn", true).end_object();
  return json.take();
}

/// What symbolic links in the folder lead to.
std::vector<fs::path> linked_from(const fs::path& folder) {
  std::vector<fs::path> linked;
  std::error_code fault;
  for (fs::recursive_directory_iterator at(folder, fault), end; !fault && at != end; at.increment(fault)) {
    std::error_code dangling;
    if (!at->is_symlink(dangling)) continue;
    const fs::path target = fs::canonical(at->path(), dangling);
    if (!dangling) linked.push_back(target);
  }
  if (fault) throw failure(fmt::format("{}: cannot be read: {}", folder.string(), fault.message()));
  return linked;
}

}  // namespace

Withdrawal withdraw(const fs::path& study, std::uint32_t participant) {
  const ParticipantFolder folder = participant_folder(study, participant);
  std::error_code fault;
  if (!fs::is_directory(folder.path, fault)) {
    throw bad_input(study.string(),
                    fmt::format("has no participant {}: there is no folder {}", participant, folder.name()));
  }
  const Outputs outputs({{"--out", folder.path.string(), Output::Kind::continued_folder}});
  Withdrawal withdrawal{.before = folder.withdrawn()};
  // Throws while a sitting has the journal open. One that is linked is no sitting's.
  if (fs::is_regular_file(fs::symlink_status(folder.journal(), fault))) open_to_append(folder.journal());
  const std::vector<fs::path> linked = linked_from(folder.path);
  if (!withdrawal.before) open_to_append(folder.tombstone()).write(tombstone_text(participant), true);
  const auto erase = [&](const fs::path& path) {
    const std::uintmax_t files = fs::remove_all(path, fault);
    if (fault)
      throw failure(
          fmt::format("{}: cannot be erased: {}; call palpa study withdraw again", path.string(), fault.message()));
    withdrawal.files += files;
  };
  fs::directory_iterator at(folder.path, fault);
  for (const fs::directory_iterator end; !fault && at != end; at.increment(fault)) {
    if (at->path() != folder.tombstone()) erase(at->path());
  }
  if (fault) throw failure(fmt::format("{}: cannot be read: {}", folder.path.string(), fault.message()));
  for (const fs::path& target : linked) {
    if (fs::exists(target, fault)) withdrawal.remaining.push_back(target);
  }
  return withdrawal;
}

}  // namespace palpa::study
