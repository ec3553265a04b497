#include "study/sitting/record.hpp"

#include <fmt/chrono.h>
#include <fmt/core.h>

#include <ctime>
#include <filesystem>
#include <system_error>
#include <utility>

#include "base/error.hpp"
#include "base/file_register.hpp"
#include "base/output_file.hpp"
#include "study/sitting/events_table.hpp"

namespace palpa::study {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t most_journal_bytes = 64u << 20;
constexpr const char* end_of_log = "_events.tsv";

}  // namespace

Record::Record(const StudyPlan& plan, std::uint32_t participant, const std::filesystem::path& study, bool rehearsal)
    : plan_(&plan), folder_(participant_folder(study, participant)), steps_(order_of(plan, participant)) {
  if (folder_.withdrawn()) {
    throw bad_usage(fmt::format("participant {} withdrew, as {} says: give another participant another number",
                                participant, folder_.tombstone().string()));
  }
  make_folders(folder_);
  file_register::claim({{.owner = this, .option = "--out", .place = output_place(folder_.path), .is_folder = true}});
  try {
    file_ = std::make_unique<AppendFile>(folder_.journal());
    Journal journal = read_journal(file_->content(most_journal_bytes), file_->name());
    const JournalHead head{.participant = participant, .plan_sha256 = plan.sha256};
    if (journal.head && journal.head->participant != participant) {
      throw bad_input(file_->name(), fmt::format("is the journal of participant {}, not of {}",
                                                 journal.head->participant, participant));
    }
    if (journal.head && journal.head->plan_sha256 != plan.sha256) {
      throw bad_usage(
          fmt::format("{}: participant {} was begun with another plan, or {} was changed since: continue "
                      "with the same file, or give the new plan another --out",
                      file_->name(), participant, plan.file));
    }
    agenda_after(steps_, journal.entries, file_->name());
    for (const Entry& entry : journal.entries) {
      if (entry.kind != EntryKind::start || entry.rehearsal == rehearsal) continue;
      throw bad_usage(fmt::format("{}: is of a {}: give {} another --out", file_->name(),
                                  entry.rehearsal ? "rehearsal" : "person", rehearsal ? "a rehearsal" : "the study"));
    }
    refuse_unknown_logs(runs_of(journal.entries).size());
    file_->cut(journal.whole);
    entries_ = std::move(journal.entries);
    digits_ = std::move(journal.last_digits);
    if (!journal.head) {
      const std::string line = head_line(head);
      file_->add(line);
      digits_ = digits_of(line);
    }
    write_file(folder_.path / (folder_.name() + "_order.csv"), order_csv(plan, steps_));
    write_logs(true);
  } catch (...) {
    file_register::release(this);
    throw;
  }
}

Record::~Record() {
  file_register::release(this);
}

void Record::refuse_finished() const {
  if (!agenda().finished()) return;
  throw bad_usage(fmt::format("participant {} has finished: give another participant another number", folder_.number));
}

Agenda Record::agenda() const {
  return agenda_after(steps_, entries_, file_->name());
}

void Record::add(const Entry& entry) {
  const std::string line = entry_line(entry, digits_);
  file_->add(line);
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

void Record::refuse_unknown_logs(std::size_t runs) const {
  std::error_code fault;
  for (fs::directory_iterator at(folder_.beh(), fault), end; !fault && at != end; at.increment(fault)) {
    const std::string name = at->path().filename().string();
    bool known = !name.ends_with(end_of_log);
    for (std::uint32_t run = 1; run <= runs; ++run)
      known = known || at->path() == folder_.file(run, end_of_log);
    if (known) continue;
    throw bad_input(file_->name(), fmt::format("does not contain the run of {}: restore the journal, or give this "
                                               "participant another number",
                                               at->path().string()));
  }
  if (fault) throw bad_input(folder_.beh().string(), "cannot be read: " + fault.message());
}

void Record::write_log(std::uint32_t run, std::span<const Entry> entries, bool ended) const {
  const std::string table = events_table(*plan_, steps_, entries);
  // The sidecar first: without a checksum, it fits any table.
  const auto sidecar = [&](bool with_checksum) {
    write_file(folder_.file(run, "_events.json"),
               events_sidecar(*plan_, folder_.number, entries, table, with_checksum));
  };
  sidecar(false);
  write_file(folder_.file(run, end_of_log), table);
  write_file(folder_.file(run, "_stimuli.json"), stimuli_json(*plan_, steps_, entries));
  if (ended) sidecar(true);
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
