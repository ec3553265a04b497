// The log of a participant's session: PREFIX_events.tsv of BIDS, one row per event, and PREFIX_events.json beside it.
//
// A log may be damaged. A fault of the whole file throws. A faulty row is left out, and a line says so.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/words.hpp"
#include "study/plan/plan.hpp"

namespace palpa::study {

enum class EventStatus {
  answered,  ///< a trial with its answer
  done,      ///< a part without an answer
  broken,    ///< broken off, "void" in the file: it does not count
};
inline constexpr Word<EventStatus> status_words[] = {
    {"answered", EventStatus::answered}, {"done", EventStatus::done}, {"void", EventStatus::broken}};

struct EventRow {
  std::size_t line = 0;  ///< in the file, from 1
  double onset_s = 0;
  std::optional<double> duration_s{};
  BlockKind kind = BlockKind::trial;  ///< trial_type
  EventStatus status = EventStatus::answered;
  std::string method{}, shape{}, answer{};  ///< empty where the file has n/a
  std::optional<double> response_s{};

  bool operator==(const EventRow&) const = default;
};

struct EventsFile {
  std::string name{};                 ///< path, for messages
  std::vector<EventRow> rows{};       ///< in the order of the file
  std::vector<std::string> shapes{};  ///< that the file beside it names; may be empty
  std::uint32_t least_trials = 0;     ///< that the file beside it gives
  std::string plan_sha256{};          ///< that the file beside it gives; may be empty
  bool rehearsal = false;             ///< as the file beside it says
  std::vector<std::string> faults{};  ///< a line for each row that is left out, with file and line
};

/// Throws bad_input if the text is not a table with all columns, or has too many rows. `name` is for messages.
EventsFile parse_events(std::string_view text, const std::string& name);

/// Reads PREFIX_events.tsv and PREFIX_events.json. Throws as parse_events() and read_events_sidecar(). A missing
/// sidecar is only reported, and so is a log that was changed after its session.
EventsFile read_events(const std::filesystem::path& file);

}  // namespace palpa::study
