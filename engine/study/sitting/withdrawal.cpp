#include "study/sitting/withdrawal.hpp"

#include <fmt/core.h>

#include <system_error>

#include "base/append_file.hpp"
#include "base/error.hpp"
#include "base/file_register.hpp"
#include "base/json_writer.hpp"
#include "study/sitting/participant_folder.hpp"

namespace palpa::study {
namespace {

namespace fs = std::filesystem;

/// While it lives, the participant's folder may be written.
class Claimed {
 public:
  explicit Claimed(const fs::path& folder) {
    file_register::claim({{.owner = this, .option = "--out", .place = output_place(folder), .is_folder = true}});
  }
  ~Claimed() { file_register::release(this); }
  Claimed(const Claimed&) = delete;
  Claimed& operator=(const Claimed&) = delete;
};

std::string tombstone_text(std::uint32_t participant) {
  JsonWriter json;
  json.begin_object().member("Participant", participant).member("Withdrawn", true).end_object();
  return json.take();
}

}  // namespace

Withdrawal withdraw(const fs::path& study, std::uint32_t participant) {
  const ParticipantFolder folder = participant_folder(study, participant);
  std::error_code fault;
  if (!fs::is_directory(folder.path, fault)) {
    throw bad_input(study.string(),
                    fmt::format("has no participant {}: there is no folder {}", participant, folder.name()));
  }
  const Claimed claimed(folder.path);
  Withdrawal withdrawal{.before = folder.withdrawn()};
  // Throws while a sitting has the journal open.
  if (fs::exists(folder.journal(), fault)) const AppendFile journal(folder.journal());
  if (!withdrawal.before) {
    AppendFile tombstone(folder.tombstone());
    tombstone.add(tombstone_text(participant));
  }
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
  return withdrawal;
}

}  // namespace palpa::study
