#include "study/sitting/withdrawal.hpp"

#include <fmt/core.h>
#include <sys/stat.h>

#include <algorithm>
#include <map>
#include <system_error>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "base/files/json_writer.hpp"
#include "base/files/output_file.hpp"
#include "base/files/outputs.hpp"
#include "study/sitting/participant_folder.hpp"

namespace palpa::study {
namespace {

namespace fs = std::filesystem;

std::string tombstone_text(std::uint32_t participant) {
  JsonWriter json;
  json.begin_object().member("Participant", participant).member("Withdrawn", true).end_object();
  return json.take();
}

struct Links {
  std::vector<fs::path> targets;        ///< what symbolic links in the folder lead to
  std::vector<OtherNames> other_names;  ///< of files in the folder
};

Links links_in(const fs::path& folder) {
  Links links;
  std::map<std::pair<dev_t, ino_t>, OtherNames> files;
  std::error_code fault;
  for (fs::recursive_directory_iterator at(folder, fault), end; !fault && at != end; at.increment(fault)) {
    std::error_code dangling;
    struct stat status {};
    if (at->is_symlink(dangling)) {
      const fs::path target = fs::canonical(at->path(), dangling);
      if (!dangling) links.targets.push_back(target);
    } else if (::lstat(at->path().c_str(), &status) == 0 && S_ISREG(status.st_mode)) {
      OtherNames& file = files[{status.st_dev, status.st_ino}];
      if (file.file.empty()) file = {.file = at->path(), .names = status.st_nlink, .inode = status.st_ino};
      --file.names;  // this one is erased
    }
  }
  if (fault) throw failure(fmt::format("{}: cannot be read: {}", folder.string(), fault.message()));
  for (const auto& [identity, file] : files) {
    if (file.names > 0) links.other_names.push_back(file);
  }
  std::ranges::sort(links.other_names, {}, &OtherNames::file);
  return links;
}

}  // namespace

Withdrawal withdraw(const fs::path& study, std::uint32_t participant) {
  const ParticipantFolder folder = participant_folder(study, participant);
  std::error_code fault;
  if (!fs::is_directory(folder.path, fault)) {
    throw bad_input(study.string(),
                    fmt::format("has no participant {}: there is no folder {}", participant, folder.name()));
  }
  const Outputs outputs({{"--out", folder.path.string(), Output::Kind::personal_folder}});
  Withdrawal withdrawal{.before = folder.withdrawn()};
  // Throws while a sitting has the journal open. One that is linked is no sitting's.
  if (fs::is_regular_file(fs::symlink_status(folder.journal(), fault))) open_to_append(folder.journal());
  Links links = links_in(folder.path);
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
  withdrawal.other_names = std::move(links.other_names);
  for (const fs::path& target : links.targets) {
    if (fs::exists(target, fault)) withdrawal.remaining.push_back(target);
  }
  return withdrawal;
}

}  // namespace palpa::study
