#include "study/sitting/withdrawal.hpp"

#include <fmt/core.h>

#include <system_error>

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
  // Throws while a sitting has the journal open.
  if (fs::exists(folder.journal(), fault)) open_to_append(folder.journal());
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
  return withdrawal;
}

}  // namespace palpa::study
