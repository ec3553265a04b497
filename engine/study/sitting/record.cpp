#include "study/sitting/record.hpp"

#include <fmt/chrono.h>
#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <ctime>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <tuple>
#include <utility>

#include "base/error.hpp"
#include "base/files/input_file.hpp"
#include "base/files/lines.hpp"
#include "base/text.hpp"
#include "study/files/sidecar.hpp"
#include "study/sitting/events_table.hpp"

namespace palpa::study {
namespace {

// ---- what must stay the same in a study: the plan for all its participants, and the models of its shapes

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

/// Throws bad_usage if a touch was played with another model than the plan's shape has now (PlanShape::model_sha256).
/// `journal`: its file, for messages.
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

/// Throws bad_usage if another participant in the folder of the study was begun with another plan, or touched other
/// models. Journals that cannot be read are left to their own participants.
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

namespace fs = std::filesystem;

constexpr const char* end_of_log = "_events.tsv";

/// The names of all files in a folder and below it, sorted, from that folder on.
std::vector<std::string> files_in(const fs::path& folder) {
  std::vector<std::string> files;
  std::error_code fault;
  for (fs::recursive_directory_iterator at(folder, fault), end; !fault && at != end; at.increment(fault)) {
    if (!at->is_directory(fault)) files.push_back(at->path().lexically_relative(folder).string());
  }
  if (fault) throw bad_input(folder.string(), "cannot be read: " + fault.message());
  std::ranges::sort(files);
  return files;
}

/// The run of a file such as sub-07_task-shapes_run-02_shapes.glb.
std::optional<std::uint32_t> run_of(const std::string& file, const std::string& participant) {
  const std::string before = participant + "_task-shapes_run-";
  if (!file.starts_with(before)) return std::nullopt;
  std::uint32_t run = 0;
  const auto [end, fault] = std::from_chars(file.data() + before.size(), file.data() + file.size(), run);
  return fault == std::errc{} ? std::optional(run) : std::nullopt;
}

/// The rows of a log up to its last line end. A program that was killed, or a power cut, may leave less than was
/// written.
std::vector<std::vector<std::string_view>> rows_in(std::string_view table) {
  std::vector<std::vector<std::string_view>> rows;
  Lines lines(table);
  while (const std::optional<std::string_view> line = lines.next()) {
    if (!lines.cut()) rows.push_back(cells_of(*line, '\t'));
  }
  return rows;
}

/// Whether each row of a log is in `table`, in this order. A log of another version of palpa may lack columns.
bool contains_rows(const std::string& table, const std::string& log) {
  const auto all = rows_in(table), some = rows_in(log);
  if (some.empty()) return true;
  std::vector<std::pair<std::size_t, std::size_t>> columns;
  for (std::size_t i = 0; i < some[0].size(); ++i) {
    const auto found = std::ranges::find(all[0], some[0][i]);
    if (found != all[0].end()) columns.emplace_back(i, found - all[0].begin());
  }
  auto at = all.begin();
  return !columns.empty() && std::ranges::all_of(some, [&](const auto& row) {
    at = std::ranges::find_if(at, all.end(), [&](const auto& other) {
      return row.size() == some[0].size() &&
             std::ranges::all_of(columns, [&](const auto& both) { return row[both.first] == other[both.second]; });
    });
    if (at == all.end()) return false;
    ++at;
    return true;
  });
}

/// A journal or a log may be empty.
std::string content_of(const std::filesystem::path& file) {
  std::error_code fault;
  return std::filesystem::file_size(file, fault) == 0 ? std::string() : read_file(file, most_journal_bytes);
}

}  // namespace

Record::Record(const StudyPlan& plan, std::uint32_t participant, const std::filesystem::path& study, bool rehearsal,
               const std::function<void()>& try_out)
    : plan_(&plan), folder_(participant_folder(study, participant)), steps_(order_of(plan, participant)) {
  if (folder_.withdrawn()) {
    throw bad_usage(fmt::format("participant {} withdrew, as {} says: give another participant another number",
                                participant, folder_.tombstone().string()));
  }
  refuse_lost_journal();
  const bool begins = is_new();
  if (begins) {
    refuse_other_study(plan, study, folder_);
    try_out();
  }
  make_folders(folder_);
  outputs_.emplace(std::vector<Output>{{"--out", folder_.path.string(), Output::Kind::personal_folder}});
  file_ = open_to_append(folder_.journal());
  remove_leftovers(folder_);
  Journal journal = read_journal(content_of(folder_.journal()), file_.name());
  const JournalHead head{.participant = participant, .plan_sha256 = plan.sha256};
  if (journal.head && journal.head->participant != participant) {
    throw bad_input(file_.name(),
                    fmt::format("is the journal of participant {}, not of {}", journal.head->participant, participant));
  }
  if (journal.head && journal.head->plan_sha256 != plan.sha256) {
    throw bad_usage(
        fmt::format("{}: participant {} was begun with another plan, or {} was changed since: continue "
                    "with the same file, or give the new plan another --out",
                    file_.name(), participant, plan.file));
  }
  const bool steps_left = agenda_after(steps_, journal.entries, file_.name()).current().has_value();
  for (const Entry& entry : journal.entries) {
    if (entry.kind != EntryKind::start || entry.rehearsal == rehearsal) continue;
    throw bad_usage(fmt::format("{}: is of a {}: give {} another --out", file_.name(),
                                entry.rehearsal ? "rehearsal" : "person", rehearsal ? "a rehearsal" : "the study"));
  }
  refuse_unknown_files(journal.entries);
  if (!begins && steps_left) {
    refuse_other_models(plan, steps_, journal.entries, file_.name());
    try_out();
  }
  restrict_to_owner(folder_);
  file_.cut(journal.whole);
  entries_ = std::move(journal.entries);
  digits_ = std::move(journal.last_digits);
  if (!journal.head) {
    const std::string line = head_line(head);
    file_.write(line, true);
    digits_ = digits_of(line);
  }
  write_file(folder_.path / (folder_.name() + "_order.csv"), order_csv(plan, steps_));
  write_logs(true);
}

void Record::refuse_finished() const {
  if (!agenda().finished()) return;
  throw bad_usage(fmt::format("participant {} has finished: give another participant another number", folder_.number));
}

Agenda Record::agenda() const {
  return agenda_after(steps_, entries_, file_.name());
}

void Record::add(const Entry& entry) {
  const std::string line = entry_line(entry, digits_);
  if (!file_.is_at(folder_.journal())) {
    throw failure(
        file_.name() +
        ": was removed or replaced while it was written: put it back, or give this participant another number");
  }
  file_.write(line, true);
  digits_ = digits_of(line);
  entries_.push_back(entry);
  switch (entry.kind) {
    case EntryKind::answer:
    case EntryKind::done:
    case EntryKind::broken: {
      const auto runs = runs_of(entries_);
      write_log(static_cast<std::uint32_t>(runs.size()), runs.back(), false);
      break;
    }
    case EntryKind::stop:
    case EntryKind::finish:
      write_logs(true);
      break;
    default:
      break;
  }
}

/// A journal that is empty or not there is that of a new participant, who has no files yet.
bool Record::is_new() const {
  std::error_code fault;
  const fs::path journal = folder_.journal();
  return !fs::exists(journal, fault) || (fs::is_regular_file(journal, fault) && fs::file_size(journal, fault) == 0);
}

void Record::refuse_lost_journal() const {
  std::error_code fault;
  if (!is_new() || !fs::is_directory(folder_.path, fault)) return;
  const fs::path journal = folder_.journal();
  const bool there = fs::exists(journal, fault);
  std::vector<std::string> files = files_in(folder_.path);
  std::erase(files, journal.filename().string());
  if (files.empty()) return;
  const auto log = std::ranges::find_if(files, [](const std::string& file) { return file.ends_with(end_of_log); });
  throw bad_input(
      journal.string(),
      fmt::format("{}, but there {} {} of participant {} in {}, such as {}: restore the journal, or give "
                  "this participant another number; nothing was changed",
                  there ? "is empty" : "is missing", files.size() == 1 ? "is" : "are", counted(files.size(), "file"),
                  folder_.number, folder_.path.string(), log != files.end() ? *log : files.front()));
}

/// Files that the journal does not know would be replaced, or be taken for those of a later run.
void Record::refuse_unknown_files(std::span<const Entry> entries) const {
  const auto runs = runs_of(entries);
  const auto refuse = [&](const std::string& file, const char* what) {
    throw bad_input(file_.name(),
                    fmt::format("does not contain {} {}: restore the journal, or give this participant another number; "
                                "nothing was changed",
                                what, (folder_.beh() / file).string()));
  };
  for (const std::string& file : files_in(folder_.beh())) {
    const std::optional<std::uint32_t> run = run_of(file, folder_.name());
    const bool known = run && *run >= 1 && *run <= runs.size();
    if (!known && (run || file.ends_with(end_of_log))) refuse(file, "the run of");
    if (!known || folder_.beh() / file != folder_.file(*run, end_of_log)) continue;
    // The log is written from the journal, after each entry that ends a step.
    const std::string log = content_of(folder_.beh() / file);
    if (!contains_rows(events_table(*plan_, steps_, runs[*run - 1]), log)) refuse(file, "all rows of");
  }
}

void Record::write_log(std::uint32_t run, std::span<const Entry> entries, bool ended) const {
  const std::string table = events_table(*plan_, steps_, entries);
  // All are written before the first is put into its place, so that hardly anything can come between them. The sidecar
  // is first: without a checksum, it fits any table.
  OutputFile sidecar(folder_.file(run, "_events.json")), log(folder_.file(run, end_of_log)),
      stimuli(folder_.file(run, "_stimuli.json"));
  sidecar.write(events_sidecar(*plan_, folder_.number, entries, table, false));
  log.write(table);
  stimuli.write(stimuli_json(*plan_, steps_, entries));
  sidecar.finish();
  log.finish();
  stimuli.finish();
  if (ended)
    write_file(folder_.file(run, "_events.json"), events_sidecar(*plan_, folder_.number, entries, table, true));
}

void Record::write_logs(bool ended) const {
  const auto runs = runs_of(entries_);
  for (std::size_t run = 0; run < runs.size(); ++run)
    write_log(static_cast<std::uint32_t>(run + 1), runs[run], ended || run + 1 < runs.size());
}

std::string utc_now() {
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)));
}

}  // namespace palpa::study
