#include "study/files/events_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <system_error>
#include <utility>

#include "base/error.hpp"
#include "base/files/input_file.hpp"
#include "base/files/lines.hpp"
#include "base/text.hpp"
#include "base/units.hpp"
#include "study/files/gzip.hpp"
#include "study/files/sidecar.hpp"
#include "study/files/trial.hpp"

namespace palpa::study {
namespace {

enum Column { onset, duration, trial_type, method, shape, answer, response_time, status, column_count };
constexpr std::array<std::string_view, column_count> column_names{"onset", "duration", "trial_type",    "method",
                                                                  "shape", "answer",   "response_time", "status"};

constexpr std::uint64_t most_bytes = 16 << 20;
constexpr std::size_t most_rows = 100'000;
/// Further faults are only counted, so that a foreign file does not flood its reader.
constexpr std::size_t most_faults = 10;

/// The place of each column in the file.
using Places = std::array<std::size_t, column_count>;

/// More columns are refused.
constexpr std::size_t most_columns = 1000;

bool same_letters(std::string_view a, std::string_view b) {
  const auto small = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; };
  return std::ranges::equal(a, b, {}, small, small);
}

/// A column of that name; if there is none, one of that name in other letters, such as Onset.
std::size_t place_of(std::span<const std::string> header, std::string_view column, const std::string& name) {
  const auto same = [&](const std::string& other) { return other == column; };
  const auto alike = [&](const std::string& other) { return same_letters(other, column); };
  auto found = std::ranges::find_if(header, same);
  const bool exact = found != header.end();
  if (!exact) found = std::ranges::find_if(header, alike);
  if (found == header.end()) {
    constexpr std::size_t most_shown = 20;
    std::vector<std::string> columns;
    for (const std::string& other : header.first(std::min(header.size(), most_shown)))
      columns.push_back(printable(other, 30));
    throw bad_input(name, fmt::format("line 1: the column {} is missing: the line has {}{}; the columns are {}, "
                                      "separated by tabs",
                                      column, fmt::join(columns, ", "), header.size() > most_shown ? ", ..." : "",
                                      fmt::join(column_names, ", ")));
  }
  const std::span<const std::string> after(found + 1, header.end());
  if (exact ? std::ranges::any_of(after, same) : std::ranges::any_of(after, alike))
    throw bad_input(name, fmt::format("line 1: the column {} is there twice", column));
  return static_cast<std::size_t>(found - header.begin());
}

Places places_of(std::span<const std::string> header, const std::string& name) {
  if (header.size() > most_columns)
    throw bad_input(name, fmt::format("line 1: has more than {} columns", most_columns));
  Places places{};
  for (std::size_t c = 0; c < column_count; ++c)
    places[c] = place_of(header, column_names[c], name);
  return places;
}

std::string shown(std::string_view cell) {
  return printable(cell, 40);
}

/// Fills `row` from the cells of a line; returns the fault, empty if there is no fault.
std::string read_row(const std::vector<std::string>& cells, const Places& places, EventRow& row) {
  const auto cell = [&](Column column) -> const std::string& { return cells[places[column]]; };
  const auto time = [&](Column column, std::optional<double>& target) {
    if (cell(column) == not_available) return true;
    target = parse_number(cell(column));
    return target && *target >= 0;
  };
  const auto not_a_time = [&](Column column) {
    return fmt::format("{} '{}' is not a time in seconds, such as 1.25", column_names[column], shown(cell(column)));
  };
  const std::optional<double> begin = parse_number(cell(onset));
  if (!begin || *begin < 0) return not_a_time(onset);
  row.onset_s = *begin;
  if (!time(duration, row.duration_s)) return not_a_time(duration);
  if (!time(response_time, row.response_s)) return not_a_time(response_time);

  const std::optional<BlockKind> kind = value_of(block_words, cell(trial_type));
  if (!kind) return fmt::format("trial_type '{}' is not {}", shown(cell(trial_type)), one_of(block_words));
  row.kind = *kind;
  const std::optional<EventStatus> state = value_of(status_words, cell(status));
  if (!state) return fmt::format("status '{}' is not {}", shown(cell(status)), one_of(status_words));
  row.status = *state;

  const bool counts = row.kind == BlockKind::trial && row.status == EventStatus::answered;
  for (const auto& [column, target] : {std::pair(method, &row.method), {shape, &row.shape}, {answer, &row.answer}}) {
    const bool missing = cell(column).empty() || cell(column) == not_available;
    if (counts && missing) return fmt::format("an answered trial has no {}", column_names[column]);
    if (cell(column).size() > most_name)
      return fmt::format("{} '{}' is longer than {} letters", column_names[column], shown(cell(column)), most_name);
    if (!missing) *target = cell(column);
  }
  if (row.kind == BlockKind::trial && row.status == EventStatus::done)
    return "a trial has the status done, but only answered or void fit";
  return {};
}

}  // namespace

EventsFile parse_events(std::string_view text, const std::string& name) {
  EventsFile file{.name = name};
  Lines lines(text);
  const std::optional<std::string_view> first = lines.next();
  if (!first) throw bad_input(name, "is empty");
  const std::vector<std::string> header = plain_cells_of(*first, '\t', most_columns);
  const Places places = places_of(header, name);

  std::size_t faulty = 0;
  const auto leave_out = [&](const std::string& fault) {
    if (++faulty <= most_faults)
      file.faults.push_back(fmt::format("{}: line {}: {}; the row is left out", name, lines.number(), fault));
  };
  while (const std::optional<std::string_view> line = lines.next()) {
    if (line->empty()) continue;
    if (lines.number() > most_rows) throw bad_input(name, fmt::format("has more than {} lines", most_rows));
    const std::vector<std::string> cells = plain_cells_of(*line, '\t', most_columns);
    if (lines.cut()) {
      leave_out("the line has no end: the file is cut off here");
    } else if (cells.size() != header.size()) {
      leave_out(fmt::format("{} where the first line has {}", counted(cells.size(), "cell"), header.size()));
    } else {
      EventRow row{.line = lines.number()};
      if (const std::string fault = read_row(cells, places, row); !fault.empty()) {
        leave_out(fault);
      } else if (!file.rows.empty() && row.onset_s == file.rows.back().onset_s) {
        leave_out(fmt::format("it has the same onset as line {}", file.rows.back().line));
      } else if (!file.rows.empty() && row.onset_s < file.rows.back().onset_s) {
        leave_out(fmt::format("its onset {} lies before that of line {}", row.onset_s, file.rows.back().line));
      } else {
        file.rows.push_back(std::move(row));
      }
    }
  }
  if (faulty > most_faults)
    file.faults.push_back(fmt::format("{}: {} further rows are left out", name, faulty - most_faults));
  return file;
}

EventsFile read_events(const std::filesystem::path& path) {
  const std::string text = read_text_file(path, most_bytes), name = path.string();
  std::filesystem::path beside = path;
  beside.replace_extension(".json");
  std::error_code fault;
  if (!std::filesystem::exists(beside, fault)) {
    EventsFile file = parse_events(text, name);
    file.faults.push_back(fmt::format("{}: there is no {} beside it; it is read as version {}", name,
                                      beside.filename().string(), log_version));
    return file;
  }
  const EventsSidecar sidecar = read_events_sidecar(beside);
  EventsFile file = parse_events(text, name);
  file.shapes = sidecar.shapes;
  file.least_trials = sidecar.least_trials;
  file.plan_sha256 = sidecar.plan_sha256;
  file.rehearsal = sidecar.rehearsal;
  if (sidecar.rehearsal)
    file.faults.push_back(name + ": is a rehearsal: no person gave these answers; it is analysed all the same");
  if (sidecar.checksum && *sidecar.checksum != crc32_of(text)) {
    file.faults.push_back(
        fmt::format("{}: was changed after its session ended (its CRC-32 is {:08x}, {} says {:08x}); it is analysed as "
                    "it is",
                    name, crc32_of(text), beside.filename().string(), *sidecar.checksum));
  }
  return file;
}

}  // namespace palpa::study
