#include "sweep/crate.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <ctime>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <utility>

#include "base/error.hpp"
#include "base/output_file.hpp"
#include "base/sha256.hpp"
#include "base/text.hpp"
#include "base/version.hpp"

namespace palpa::sweep {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* metadata_name = "ro-crate-metadata.json";
constexpr const char* copied_plan_name = "plan.toml";
constexpr const char* provenance_name = "provenance.csv";

fs::path folder_of(const std::string& file) {
  return fs::path(".") / fs::path(file).parent_path();
}

fs::path beside(const std::string& file, const char* name) {
  return fs::path(file).parent_path() / name;
}

bool is_there(const fs::path& file) {
  std::error_code ignored;
  return fs::exists(file, ignored);
}

bool is_same(const fs::path& one, const fs::path& other) {
  std::error_code ignored;
  return fs::equivalent(one, other, ignored);
}

bool lies_beside(const std::string& plan_file, const std::string& file) {
  return is_same(folder_of(plan_file), folder_of(file));
}

/// UTC, as ISO 8601 has it.
std::string iso_time(std::int64_t seconds) {
  const std::time_t time = seconds;
  std::tm parts{};
  gmtime_r(&time, &parts);
  std::array<char, 32> text{};
  std::strftime(text.data(), text.size(), "%Y-%m-%dT%H:%M:%SZ", &parts);
  return text.data();
}

Json refer(const std::string& id) {
  return {{"@id", id}};
}

std::string provenance_csv(const Table& table) {
  std::string csv = "id,state,took_s,ended,run,host,device,error\n";
  for (const Row& row : table.rows) {
    const RunInfo& run = table.runs[row.run];
    csv += fmt::format("{},{},{},{},{},{},{},{}\n", row.id, word_of(state_words, row.state), row.took_s,
                       iso_time(row.ended_s), csv_cell(run.name), csv_cell(run.host), csv_cell(run.device),
                       csv_cell(row.error));
  }
  return csv;
}

/// What a run did.
struct Share {
  std::uint64_t cases = 0, faults = 0;
  double seconds = 0;
  std::int64_t ended_s = 0;
};

std::map<std::size_t, Share> shares_of(const Table& table) {
  std::map<std::size_t, Share> shares;
  for (const Row& row : table.rows) {
    Share& share = shares[row.run];
    ++share.cases;
    share.faults += row.state == State::done ? 0 : 1;
    share.seconds += row.took_s;
    share.ended_s = std::max(share.ended_s, row.ended_s);
  }
  return shares;
}

class Metadata {
 public:
  Metadata(const Plan& plan, const Inputs& inputs, const Table& table, const std::string& file,
           const std::string& results, const std::string& cases)
      : plan_(plan),
        table_(table),
        results_(fs::path(file).filename().string()),
        plan_name_(lies_beside(plan.file, file) ? fs::path(plan.file).filename().string() : copied_plan_name) {
    add_root(table.rows.size());
    add_file(results_, results_.ends_with(".csv") ? "text/csv" : "application/x-hdf5", "The results", results);
    add_file(plan_name_, "application/toml", "The plan of the sweep", plan.text);
    add_file(provenance_name, "text/csv", "When, where and how each case ended", cases);
    for (const Input& input : inputs.all())
      add_input(input);
    graph_.push_back({{"@id", "#palpa"},
                      {"@type", "SoftwareApplication"},
                      {"name", "palpa"},
                      {"version", version()},
                      {"identifier", commit()}});
    for (const auto& [run, share] : shares_of(table))
      add_run(table.runs[run], share);
  }

  std::string text() const {
    const Json document{{"@context", "https://w3id.org/ro/crate/1.1/context"}, {"@graph", graph_}};
    return document.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
  }

 private:
  void add_root(std::size_t rows) {
    graph_.push_back({{"@id", metadata_name},
                      {"@type", "CreativeWork"},
                      {"conformsTo", refer("https://w3id.org/ro/crate/1.1")},
                      {"about", refer("./")}});
    Json parts = Json::array();
    for (const std::string& name : {results_, plan_name_, std::string(provenance_name)})
      parts.push_back(refer(name));
    Json actions = Json::array();
    for (const auto& [run, share] : shares_of(table_))
      actions.push_back(refer("#" + table_.runs[run].name));
    graph_.push_back(
        {{"@id", "./"},
         {"@type", "Dataset"},
         {"name", fmt::format("Results of palpa {} for {}", plan_.command, fs::path(plan_.file).filename().string())},
         {"description",
          fmt::format("{} of {} of a sweep with palpa {}", rows, counted(plan_.count(), "case"), version_and_commit())},
         {"datePublished", iso_time(seconds_now())},
         {"license", "The author of the data should add its licence."},
         {"hasPart", parts},
         {"mentions", actions}});
  }

  void add_file(const std::string& name, const char* type, const char* what, const std::string& bytes) {
    graph_.push_back({{"@id", name},
                      {"@type", "File"},
                      {"name", what},
                      {"encodingFormat", type},
                      {"contentSize", fmt::format("{}", bytes.size())},
                      {"sha256", sha256(bytes)}});
  }

  void add_input(const Input& input) {
    const std::string id = fmt::format("#input-{}", ++inputs_);
    graph_.push_back({{"@id", id},
                      {"@type", "CreativeWork"},
                      {"name", input.name},
                      {"contentSize", fmt::format("{}", input.bytes)},
                      {"sha256", input.sha256}});
    objects_.push_back(refer(id));
  }

  std::string device_id(const std::string& name) {
    const auto [known, is_new] = devices_.emplace(name, fmt::format("#device-{}", devices_.size() + 1));
    if (is_new) graph_.push_back({{"@id", known->second}, {"@type", "Product"}, {"name", name}});
    return known->second;
  }

  void add_run(const RunInfo& run, const Share& share) {
    Json objects = Json::array({refer(plan_name_)});
    objects.insert(objects.end(), objects_.begin(), objects_.end());
    const std::string device = device_id(run.device);
    graph_.push_back({{"@id", "#" + run.name},
                      {"@type", "CreateAction"},
                      {"name", fmt::format("palpa sweep, shard {}, on {}", run.shard, run.host)},
                      {"description", fmt::format("{} in {:.3f} s, {} of them without a result",
                                                  counted(share.cases, "case"), share.seconds, share.faults)},
                      {"instrument", Json::array({refer("#palpa"), refer(device)})},
                      {"object", objects},
                      {"result", refer(results_)},
                      {"startTime", iso_time(run.started_s)},
                      {"endTime", iso_time(share.ended_s)}});
  }

  const Plan& plan_;
  const Table& table_;
  std::string results_;
  std::string plan_name_;
  Json graph_ = Json::array();
  Json objects_ = Json::array();
  std::map<std::string, std::string> devices_;
  int inputs_ = 0;
};

bool needs_copy(const std::string& plan_file, const std::string& file) {
  return !lies_beside(plan_file, file) && !is_same(plan_file, beside(file, copied_plan_name));
}

}  // namespace

std::vector<std::string> files_of_crate(const std::string& plan_file, const std::string& file) {
  std::vector<std::string> files{file, beside(file, metadata_name), beside(file, provenance_name)};
  if (needs_copy(plan_file, file)) files.push_back(beside(file, copied_plan_name));
  return files;
}

void refuse_other_crate(const std::string& plan_file, const std::string& out, const std::string& file) {
  const fs::path metadata = beside(file, metadata_name);
  if (is_there(metadata)) {
    if (is_there(file)) return;
    throw failure(fmt::format("{}: describes other results than {}; gather into another folder", metadata.string(),
                              fs::path(file).filename().string()));
  }
  if (is_same(folder_of(file), out)) return;
  for (const std::string& name : files_of_crate(plan_file, file)) {
    if (name == file || !is_there(name)) continue;
    throw failure(
        fmt::format("{}: is not of these results, and --gather would replace it; gather into another folder", name));
  }
}

void write_crate(const Plan& plan, const Inputs& inputs, const Table& table, const std::string& file,
                 const std::string& results) {
  const std::string cases = provenance_csv(table);
  // The metadata come first: with them, what a full disk has left is known as a crate, and is replaced the next time.
  write_file(beside(file, metadata_name), Metadata(plan, inputs, table, file, results, cases).text());
  write_file(beside(file, provenance_name), cases);
  if (needs_copy(plan.file, file)) write_file(beside(file, copied_plan_name), plan.text);
}

}  // namespace palpa::sweep
