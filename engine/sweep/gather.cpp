#include "sweep/gather.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <unordered_map>
#include <utility>

#include "base/error.hpp"
#include "base/locked_bytes.hpp"
#include "base/output_file.hpp"
#include "base/outputs.hpp"
#include "base/text.hpp"
#include "sweep/cases.hpp"
#include "sweep/crate.hpp"
#include "sweep/hdf5_table.hpp"
#include "sweep/results.hpp"

namespace palpa::sweep {
namespace {

using Json = nlohmann::ordered_json;

/// The results in a line, as JSON texts. Throws nlohmann's exceptions if it is not as to_json_line() writes it.
void read_line_into(Row& row, std::string_view line, const Plan& plan) {
  const Json json = Json::parse(line);
  row.took_s = json.value("took_s", 0.0);
  row.ended_s = json.value("ended_s", std::int64_t{0});
  row.error = json.value("error", std::string());
  row.results.clear();
  if (row.state != State::done) return;
  if (json.contains("json")) {
    row.results = results_of(json["json"].dump(), plan.results);
    return;
  }
  // The digits as they were written.
  for (const std::string& path : plan.results) {
    const Json value = json.contains("results") ? json["results"].value(path, Json()) : Json();
    row.results.push_back(value.is_number_float() ? fmt::format("{}", value.get<double>()) : value.dump());
  }
}

/// The values of the options that vary.
std::vector<std::string> varied_values(const Plan& plan, const std::vector<std::string>& varied, std::uint64_t index) {
  std::vector<std::string> values(varied.size());
  for (const Setting& setting : plan.settings(index)) {
    const auto column = std::ranges::find(varied, setting.option);
    if (column != varied.end()) values[static_cast<std::size_t>(column - varied.begin())] = setting.shown();
  }
  return values;
}

void find_empty_paths(Table& table) {
  for (std::size_t p = 0; p < table.paths.size(); ++p) {
    const bool any = std::ranges::any_of(
        table.rows, [&](const Row& row) { return row.state == State::done && row.results[p] != "null"; });
    const bool computed = std::ranges::any_of(table.rows, [](const Row& row) { return row.state == State::done; });
    if (computed && !any) table.empty_paths.push_back(table.paths[p]);
  }
}

/// A JSON text as a cell: null is empty, and texts have no quotes.
std::string cell_of(const std::string& json) {
  if (json == "null") return {};
  if (!json.starts_with('"')) return json;
  return csv_cell(Json::parse(json).get<std::string>());
}

Table table_with(const Plan& plan, const Inputs& inputs, const std::string& out) {
  Table table;
  const Store store(out);
  store.check_version();
  table.runs = store.runs();
  table.paths = plan.results;
  const std::vector<std::string> varied = plan.varied();
  for (const std::string& option : varied)
    table.varied.push_back(option.substr(2));
  const std::vector<Case> cases = list_cases(plan, inputs, false);
  std::unordered_map<std::string_view, Row> found;  // by id
  for (const Case& one : cases)
    found.try_emplace(one.id, Row{.index = one.index, .id = {}, .state = State::failed});
  std::unordered_map<std::string, bool> strangers;
  store.each([&](std::size_t run, std::string_view id, State state, std::string_view line) {
    const auto at = found.find(id);
    if (at == found.end()) {
      strangers.emplace(id, true);
      return;
    }
    Row& row = at->second;
    if (!row.id.empty() && row.state <= state) return;  // of two results, the better one; equal ones are the same
    row.id = id;
    row.state = state;
    row.run = run;
    try {
      read_line_into(row, line, plan);
    } catch (const nlohmann::json::exception&) {
      throw failure(
          fmt::format("{}/runs/{}/cases.jsonl: the line of the case {} is broken; remove it, and run the sweep "
                      "again",
                      out, table.runs[run].name, id));
    }
  });
  table.others = strangers.size();
  for (const Case& one : cases) {
    Row row = found.at(one.id);
    if (row.id.empty()) {
      ++table.missing;
      continue;
    }
    row.index = one.index;
    row.settings = varied_values(plan, varied, one.index);
    table.rows.push_back(std::move(row));
  }
  if (plan.results_given) find_empty_paths(table);
  return table;
}

}  // namespace

Table table_of(const Plan& plan, const std::string& out) {
  return table_with(plan, Inputs(plan), out);
}

std::string to_csv(const Table& table) {
  std::string csv = "id";
  for (const std::string& option : table.varied)
    csv.append(",").append(csv_cell(option));
  for (const std::string& path : table.paths)
    csv.append(",").append(csv_cell(path));
  csv += ",state\n";
  for (const Row& row : table.rows) {
    csv += row.id;
    for (const std::string& value : row.settings)
      csv.append(",").append(csv_cell(value));
    for (std::size_t p = 0; p < table.paths.size(); ++p)
      csv.append(",").append(row.state == State::done ? cell_of(row.results[p]) : std::string());
    csv.append(",").append(word_of(state_words, row.state)).append("\n");
  }
  return csv;
}

void check_table_name(const std::string& file) {
  const std::string ending = std::filesystem::path(file).extension().string();
  if (ending == ".csv" || (ending == ".h5" && has_hdf5())) return;
  if (ending == ".h5") throw bad_usage("--gather: this palpa was built without HDF5; give a file that ends in .csv");
  throw bad_usage(fmt::format("--gather: {} must end in .csv{}", file, has_hdf5() ? " or .h5" : ""));
}

Gathered gather(const Plan& plan, const std::string& out, const std::string& file, bool partial) {
  check_table_name(file);
  refuse_other_crate(plan.file, out, file);
  std::vector<Output> written;
  for (const std::string& name : files_of_crate(plan.file, file))
    written.push_back({"--gather", name});
  const Outputs outputs(written);
  refuse_output_as_input(plan.file);  // it was read before
  const Inputs inputs(plan);
  const Table table = table_with(plan, inputs, out);
  const auto cases = static_cast<std::uint64_t>(table.rows.size()) + table.missing;
  if (table.rows.empty()) throw failure(fmt::format("{}: has no result of this plan; compute it first", out));
  if (table.missing != 0 && !partial) {
    throw failure(fmt::format("{}: {} of {} {} no result yet; run the sweep again, or give --partial", out,
                              table.missing, counted(cases, "case"), table.missing == 1 ? "has" : "have"));
  }
  LockedBytes lock(std::filesystem::path(out) / "gather-lock");
  if (!lock.try_lock(0))
    throw failure(fmt::format("{}: another palpa sweep --gather works on it; wait until it has ended", out));
  const std::string bytes = file.ends_with(".h5") ? to_hdf5(table) : to_csv(table);
  write_file(file, bytes);
  write_crate(plan, inputs, table, file, bytes);
  Gathered gathered{table.rows.size(), table.missing, 0, 0, table.others, table.empty_paths};
  for (const Row& row : table.rows) {
    gathered.refused += row.state == State::refused ? 1 : 0;
    gathered.failed += row.state == State::failed ? 1 : 0;
  }
  return gathered;
}

}  // namespace palpa::sweep
