#include "study/sitting/same_study.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <optional>
#include <system_error>
#include <tuple>
#include <utility>

#include "base/error.hpp"
#include "base/files/input_file.hpp"
#include "base/text.hpp"
#include "study/files/sidecar.hpp"
#include "study/sitting/events_table.hpp"

namespace palpa::study {
namespace {

namespace fs = std::filesystem;

/// What the journal of another participant holds; nothing if there is none, or if it cannot be read.
Journal journal_of(const ParticipantFolder& folder) {
  std::error_code fault;
  if (!fs::is_regular_file(folder.journal(), fault)) return {};
  try {
    return read_journal(read_file(folder.journal(), most_journal_bytes), folder.journal().string());
  } catch (const Error&) {
    return {};
  }
}

/// The plan that a participant's logs name, and the log that names it.
std::optional<std::pair<std::string, std::string>> plan_of_logs(const ParticipantFolder& folder) {
  std::error_code fault;
  for (fs::directory_iterator at(folder.beh(), fault), end; !fault && at != end; at.increment(fault)) {
    if (!at->path().string().ends_with("_events.json")) continue;
    try {
      const std::string plan = read_events_sidecar(at->path()).plan_sha256;
      if (!plan.empty()) return std::pair(plan, at->path().string());
    } catch (const Error&) {
      continue;
    }
  }
  return std::nullopt;
}

}  // namespace

void refuse_other_models(const StudyPlan& plan, std::span<const Step> steps, std::span<const Entry> entries,
                         const std::string& journal) {
  for (const PlayedStep& touch : played_steps(plan, steps, entries)) {
    const auto shape = std::ranges::find(plan.shapes, touch.shape, &PlanShape::name);
    if (!touch.entry->stimulus || shape == plan.shapes.end()) continue;
    const std::string& played = touch.entry->stimulus->model_sha256;
    if (played.empty() || shape->model_sha256.empty() || played == shape->model_sha256) continue;
    throw bad_usage(
        fmt::format("{}: the model of '{}' was another one when it was touched ({} was changed since): put "
                    "that model back, or give the study with the new one another --out",
                    journal, printable(shape->name), printable(shape->model)));
  }
}

void refuse_other_study(const StudyPlan& plan, const fs::path& study, const ParticipantFolder& own) {
  for (const ParticipantFolder& other : participant_folders(study)) {
    if (other.number == own.number || other.withdrawn()) continue;
    const Journal journal = journal_of(other);
    std::string sha256, file = other.journal().string();
    if (journal.head) {
      sha256 = journal.head->plan_sha256;
    } else if (const auto logs = plan_of_logs(other)) {
      std::tie(sha256, file) = *logs;
    }
    if (!sha256.empty() && sha256 != plan.sha256) {
      throw bad_usage(
          fmt::format("{}: participant {} was begun with another plan, or {} was changed since: all "
                      "participants of a study have the same plan; give the new plan another --out",
                      file, other.number, plan.file));
    }
    if (journal.head) refuse_other_models(plan, order_of(plan, other.number), journal.entries, file);
  }
}

}  // namespace palpa::study
