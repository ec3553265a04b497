// The folder of a sweep's results. Each process that computes cases has a folder of its own in it, runs/NAME:
//   run.json      palpa's version, the device, the shard of the plan
//   cases.jsonl   a line for each case, complete or absent: the file grows by whole lines, and a last line without its
//                 end counts as absent
// Nothing is ever changed or removed, so a process that is killed loses only the case that it computes.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "base/outputs.hpp"
#include "base/stream_writer.hpp"
#include "base/words.hpp"

namespace palpa::sweep {

/// How a case ended.
enum class State {
  done,
  refused,  ///< its options do not fit together, or an input is not as the command needs it: the same for ever
  failed,   ///< for another reason, such as too little memory: computed again when the sweep continues
};

inline constexpr Word<State> state_words[] = {
    {"done", State::done}, {"refused", State::refused}, {"failed", State::failed}};

/// What a process was, for the provenance.
struct RunInfo {
  std::string name;  ///< of its folder
  std::string version, commit, command, plan_sha256, shard, host, device, backend;
  std::int64_t started_s = 0;  ///< since 1970
};

/// One line. Results are JSON texts.
struct CaseLine {
  std::string id;
  State state = State::done;
  std::vector<std::pair<std::string, std::string>> settings;  ///< option without "--", value as in the plan
  std::vector<std::pair<std::string, std::string>> results;   ///< path, JSON text; or
  std::string everything;                                     ///< all of the command's JSON
  std::string error;                                          ///< unless done: the command's message
  int exit_code = 0;
  double took_s = 0;
  std::int64_t ended_s = 0;
};
std::string to_json_line(const CaseLine& line);

/// How far each run's lines have been read, by the run's name.
struct ReadSoFar {
  std::uint64_t bytes = 0, lines = 0;
};
using Places = std::unordered_map<std::string, ReadSoFar>;

/// What the folder has so far. A folder that does not exist has nothing.
class Store {
 public:
  /// Throws failure() if it cannot be read, bad_usage if it is no folder of results.
  /// `without`: the name of a run that is left out, because this process writes it at the moment.
  explicit Store(std::string folder, const std::string& without = {});

  const std::vector<RunInfo>& runs() const { return runs_; }
  /// Throws bad_usage if another version of palpa has computed any of it.
  void check_version() const;
  /// The state of each case that has a line. If a case has several, done counts most, then refused.
  std::unordered_map<std::string, State> states() const;
  /// All complete lines: the run, an index of runs(), the case and its line. Lines that are not a case's are left out
  /// with a warning. With `places`, only those that are not yet read according to it; it is then brought up to date.
  void each(const std::function<void(std::size_t run, std::string_view id, State state, std::string_view line)>& take,
            Places* places = nullptr) const;

 private:
  std::string folder_;
  std::vector<RunInfo> runs_;
};

/// Adds lines to a folder.
class StoreWriter {
 public:
  /// Creates `folder` if necessary, and a folder for this process in it. `info.name` is ignored. Throws failure() if
  /// a file or folder cannot be written.
  StoreWriter(const std::string& folder, const RunInfo& info);
  /// When it returns, the line is in the file. Throws failure(), such as for a full disk; the line is then absent.
  void add(const CaseLine& line);
  /// The name of this process's run.
  const std::string& name() const { return name_; }

 private:
  std::string name_;
  std::unique_ptr<Outputs> outputs_;
  std::unique_ptr<StreamWriter> lines_;
};

/// This machine's name.
std::string host_name();
/// Seconds since 1970.
std::int64_t seconds_now();

}  // namespace palpa::sweep
