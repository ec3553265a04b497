#include "sweep/store.hpp"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cerrno>
#include <ctime>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <system_error>

#include "base/error.hpp"
#include "base/input_file.hpp"
#include "base/json_writer.hpp"
#include "base/log.hpp"
#include "base/output_file.hpp"
#include "base/output_place.hpp"
#include "base/text.hpp"
#include "base/version.hpp"
#include "base/words.hpp"

namespace palpa::sweep {
namespace {

namespace fs = std::filesystem;

/// A case's line with everything may have megabytes.
constexpr std::size_t most_waiting = std::size_t{1} << 30;
constexpr std::uint64_t most_file_bytes = std::uint64_t{16} << 30;
constexpr std::string_view line_begin = R"({"id":")";

std::string in_quotes(std::string_view text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

/// A folder in which the run's own file says what it was.
std::optional<RunInfo> read_run(const fs::path& folder) {
  std::error_code ignored;
  if (!fs::is_regular_file(folder / "run.json", ignored)) return std::nullopt;  // it was killed before its first case
  const auto json = nlohmann::json::parse(read_file(folder / "run.json", 1U << 20), nullptr, false);
  if (!json.is_object()) throw bad_input((folder / "run.json").string(), "is not as palpa sweep writes it");
  const auto text = [&](const char* key) {
    return json.contains(key) && json[key].is_string() ? json[key].get<std::string>() : std::string();
  };
  RunInfo run{folder.filename().string(),
              text("version"),
              text("commit"),
              text("command"),
              text("plan_sha256"),
              text("shard"),
              text("host"),
              text("device"),
              text("backend")};
  if (json.contains("started_s") && json["started_s"].is_number_integer()) run.started_s = json["started_s"];
  return run;
}

std::string to_json(const RunInfo& run) {
  JsonWriter json;
  json.begin_object()
      .member("version", std::string_view(run.version))
      .member("commit", std::string_view(run.commit))
      .member("command", std::string_view(run.command))
      .member("plan_sha256", std::string_view(run.plan_sha256))
      .member("shard", std::string_view(run.shard))
      .member("host", std::string_view(run.host))
      .member("device", std::string_view(run.device))
      .member("backend", std::string_view(run.backend))
      .member("started_s", run.started_s)
      .end_object();
  return json.take();
}

/// Bytes that to_json_line() never writes. After a power failure, a file may have zeros instead of what was written.
bool has_control_characters(std::string_view line) {
  return std::ranges::any_of(line, [](char c) { return static_cast<unsigned char>(c) < ' '; });
}

/// The id and the state at a line's beginning; nullopt if it is not a case's line.
std::optional<std::pair<std::string_view, State>> head_of(std::string_view line) {
  if (!line.starts_with(line_begin) || !line.ends_with('}') || has_control_characters(line)) return std::nullopt;
  line.remove_prefix(line_begin.size());
  const std::size_t end = line.find('"');
  if (end == std::string_view::npos) return std::nullopt;
  const std::string_view id = line.substr(0, end);
  line.remove_prefix(end);
  for (const auto& [word, state] : state_words) {
    if (line.starts_with(fmt::format(R"(","state":"{}")", word))) return std::pair(id, state);
  }
  return std::nullopt;
}

void make_folder(const fs::path& folder) {
  if (::mkdir(folder.c_str(), 0777) == 0 || errno == EEXIST) return;
  throw failure(fmt::format("{}: cannot be created: {}", folder.string(), std::system_category().message(errno)));
}

/// A new folder that no other process has: on every file system, only one of several processes creates it.
fs::path make_run_folder(const fs::path& runs, const RunInfo& info) {
  std::string host = info.host, shard = info.shard;
  for (std::string* word : {&host, &shard}) {
    for (char& c : *word)
      c = std::isalnum(static_cast<unsigned char>(c)) ? c : '-';
  }
  for (int k = 0; k < 10'000; ++k) {
    fs::path folder = runs / fmt::format("{}-{}-{}-{}-{}", shard, info.started_s, host.substr(0, 60), getpid(), k);
    if (::mkdir(folder.c_str(), 0777) == 0) return folder;
    if (errno != EEXIST) {
      throw failure(fmt::format("{}: cannot be created: {}", folder.string(), std::system_category().message(errno)));
    }
  }
  throw failure(fmt::format("{}: has no name left for this process", runs.string()));
}

}  // namespace

std::string to_json_line(const CaseLine& line) {
  std::string text =
      fmt::format(R"({}{}","state":"{}","case":{{)", line_begin, line.id, word_of(state_words, line.state));
  const auto add = [&](const auto& members, const auto& value) {
    for (std::size_t i = 0; i < members.size(); ++i)
      text += fmt::format("{}{}:{}", i == 0 ? "" : ",", in_quotes(members[i].first), value(members[i].second));
  };
  add(line.settings, in_quotes);
  text += '}';
  if (line.state != State::done) {
    text += fmt::format(R"(,"error":{},"exit":{})", in_quotes(line.error), line.exit_code);
  } else if (!line.everything.empty()) {
    text += ",\"json\":" + line.everything;
  } else {
    text += ",\"results\":{";
    add(line.results, [](const std::string& json) { return json; });
    text += '}';
  }
  return text + fmt::format(",\"took_s\":{:.6f},\"ended_s\":{}}}\n", line.took_s, line.ended_s);
}

Store::Store(std::string folder, const std::string& without) : folder_(std::move(folder)) {
  std::error_code fault;
  const fs::path runs = fs::path(folder_) / "runs";
  const fs::file_status status = fs::status(folder_, fault);
  if (!fs::exists(status)) return;
  if (!fs::is_directory(status)) throw bad_usage(fmt::format("--out: {} is not a folder", folder_));
  if (!fs::exists(runs, fault)) {
    // Another process may begin the folder at this moment.
    if (!fs::is_empty(folder_, fault) && !fs::exists(runs, fault))
      throw bad_usage(fmt::format("--out: {} has files, but is no folder of a sweep; give a new one", folder_));
    return;
  }
  std::vector<fs::path> folders;
  for (fs::directory_iterator at(runs, fault), end; !fault && at != end; at.increment(fault))
    folders.push_back(at->path());
  if (fault) throw failure(fmt::format("{}: cannot be read: {}", runs.string(), fault.message()));
  std::ranges::sort(folders);
  for (const fs::path& run : folders) {
    if (run.filename() == without) continue;
    if (std::optional<RunInfo> info = read_run(run)) runs_.push_back(std::move(*info));
  }
}

void Store::check_version() const {
  for (const RunInfo& run : runs_) {
    if (run.version == version() && run.commit == commit()) continue;
    throw bad_usage(
        fmt::format("--out: {} has results of palpa {}{}, and this is {}, which may compute others; give a new folder",
                    folder_, printable(run.version, 40),
                    run.commit.empty() ? "" : fmt::format(" ({})", printable(run.commit, 40)), version_and_commit()));
  }
}

std::unordered_map<std::string, State> Store::states() const {
  std::unordered_map<std::string, State> states;
  each([&](std::size_t, std::string_view id, State state, std::string_view) {
    const auto [known, is_new] = states.emplace(std::string(id), state);
    if (!is_new) known->second = std::min(known->second, state);
  });
  return states;
}

void Store::each(
    const std::function<void(std::size_t run, std::string_view id, State state, std::string_view line)>& take,
    Places* places) const {
  for (std::size_t r = 0; r < runs_.size(); ++r) {
    const fs::path file = fs::path(folder_) / "runs" / runs_[r].name / "cases.jsonl";
    std::error_code fault;
    ReadSoFar beginning;
    ReadSoFar& place = places ? (*places)[runs_[r].name] : beginning;
    // Killed before its first case, or nothing is new.
    if (const auto size = fs::file_size(file, fault); fault || size <= place.bytes) continue;
    const InputFile input(file, most_file_bytes);
    if (input.size() <= place.bytes) continue;
    std::string text(input.size() - place.bytes, ' ');
    input.read_at(place.bytes, {reinterpret_cast<unsigned char*>(text.data()), text.size()});
    for (std::string_view rest = text; !rest.empty();) {
      const std::size_t end = rest.find('\n');
      if (end == std::string_view::npos) break;  // killed while it wrote this line
      const std::string_view line = rest.substr(0, end);
      rest.remove_prefix(end + 1);
      place.bytes += end + 1;
      ++place.lines;
      if (const auto head = head_of(line)) {
        take(r, head->first, head->second, line);
      } else {
        log::warning(fmt::format("{}: line {}: is not a case's result, so its case is computed again", file.string(),
                                 place.lines));
      }
    }
  }
}

StoreWriter::StoreWriter(const std::string& folder, const RunInfo& info) {
  make_folder(folder);
  make_folder(fs::path(folder) / "runs");
  const fs::path own = make_run_folder(fs::path(folder) / "runs", info);
  name_ = own.filename();
  const std::string run = own / "run.json", lines = own / "cases.jsonl";
  outputs_ = std::make_unique<Outputs>(std::vector<Output>{{"--out", run}, {"--out", lines}});
  lines_ = std::make_unique<StreamWriter>(lines, most_waiting);
  write_file(run, to_json(info));
}

void StoreWriter::add(const CaseLine& line) {
  constexpr double forever_s = 1e9;
  if (!lines_->add(to_json_line(line)) || !lines_->flush(forever_s)) lines_->fail_stalled();
}

std::string host_name() {
  std::array<char, 256> name{};
  if (gethostname(name.data(), name.size() - 1) != 0) return "unknown";
  return name.data();
}

std::int64_t seconds_now() {
  return std::time(nullptr);
}

}  // namespace palpa::sweep
