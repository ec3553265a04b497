// Runs the real programs as a shell would, and keeps what they said.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace palpa::test {

/// Names and values, added to this process's.
using Environment = std::vector<std::pair<std::string, std::string>>;

struct RunOptions {
  Environment environment;
  std::string stdout_file;           ///< where stdout goes instead of into `Result::out`, e.g. /dev/full
  bool close_stdout_reader = false;  ///< stdout is a pipe that nobody reads
  double timeout_s = 120;            ///< then the program is killed, and `timed_out` is set
};

struct Result {
  int exit_code = -1;  ///< -1 where a signal ended it
  int signal = 0;
  bool timed_out = false;
  std::string out, err;
  double processor_s = 0;  ///< of all its threads
  double peak_mib = 0;     ///< resident memory
  long page_faults = 0;    ///< pages of memory that it got

  /// The lines of stderr.
  std::vector<std::string> err_lines() const;
};

/// `arguments` without the program's own name.
Result run_program(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                   const RunOptions& options = {});
/// In a forked child: becomes a program as a shell would start it, with nothing to read.
[[noreturn]] void become(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                         const Environment& environment, int out, int err);
/// For palpa: a build folder may lie outside the source tree, where it does not find its assets by itself.
Environment::value_type where_assets_are();
/// The `palpa` that this build made, and where it is.
std::string palpa_binary();
Result palpa(const std::vector<std::string>& arguments, const RunOptions& options = {});

/// A command line with more behind it.
std::vector<std::string> with(std::vector<std::string> arguments, const std::vector<std::string>& more);

/// Options of a live loop of which it does not matter what it sees, as long as that is the fingertip: its frames are
/// small_rig.toml's, without noise, which cost a twelfth of the paper's.
std::vector<std::string> small_frames();

/// gtest: the program failed with `code`, said so in one line that contains `part`, and printed no result.
void expect_failure(const Result& result, int code, const std::string& part);

}  // namespace palpa::test
