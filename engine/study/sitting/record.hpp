// The files of a sitting: the journal, to which every entry goes at once, and the logs that are written from it.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/files/output_file.hpp"
#include "base/files/outputs.hpp"
#include "study/files/journal.hpp"
#include "study/plan/order.hpp"
#include "study/plan/plan.hpp"
#include "study/sitting/agenda.hpp"
#include "study/sitting/participant_folder.hpp"

namespace palpa::study {

class Record {
 public:
  /// Opens the participant's journal in the folder of the study, or begins it. A line that was cut off is removed.
  /// Throws bad_usage if the participant withdrew, was begun with another plan or touched other models, is being run by
  /// another process, or if a rehearsal would continue a person's sitting or the reverse; for a new participant, if
  /// another one of the study has another plan or other models; bad_input for a journal that was edited, is damaged,
  /// of another version or of another participant, if it is empty or missing although the participant has files, and if
  /// there are files of runs, or rows of logs, that it does not contain; failure() if a file cannot be written. If it
  /// throws, no file of a participant was changed. `plan` must outlive it.
  ///
  /// `try_out` tries what a sitting needs, such as its link. It is called unless no step is left: for a
  /// new one before there is any file, for others when their journal was read. Its errors are passed on.
  Record(
      const StudyPlan& plan, std::uint32_t participant, const std::filesystem::path& study, bool rehearsal,
      const std::function<void()>& try_out = [] {});
  Record(const Record&) = delete;
  Record& operator=(const Record&) = delete;

  /// The state after the entries so far.
  Agenda agenda() const;
  const std::vector<Entry>& entries() const { return entries_; }
  const std::vector<Step>& steps() const { return steps_; }
  const ParticipantFolder& folder() const { return folder_; }
  /// Throws bad_usage if nothing is left to do: another participant needs another number.
  void refuse_finished() const;

  /// When it returns, the entry is on the disk. When a step is complete or void, also writes the log of this run again.
  void add(const Entry& entry);
  /// Writes the logs of all runs from the journal. `ended`: the sitting has stopped, so the last one gets its checksum.
  void write_logs(bool ended) const;

 private:
  bool is_new() const;
  void refuse_lost_journal() const;
  void refuse_unknown_files(std::span<const Entry> entries) const;
  void write_log(std::uint32_t run, std::span<const Entry> entries, bool ended) const;

  const StudyPlan* plan_;
  ParticipantFolder folder_;
  std::vector<Step> steps_;
  std::vector<Entry> entries_;
  std::string digits_;
  std::optional<Outputs> outputs_;
  OpenFile file_;  ///< the journal
};

/// The time as "2026-11-25T09:30:00Z", for the stamp of a start.
std::string utc_now();

}  // namespace palpa::study
