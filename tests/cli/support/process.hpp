// Runs the real programs like a shell does, and keeps their output.
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace palpa::test {

/// Names and values that are added to this process's environment.
using Environment = std::vector<std::pair<std::string, std::string>>;

struct RunOptions {
  Environment environment;
  std::string stdout_file;           ///< where stdout goes instead of into `Result::out`, e.g. /dev/full
  bool close_stdout_reader = false;  ///< stdout is a pipe that nobody reads
  double timeout_s = 120;            ///< after that, the program is killed and `timed_out` is set
};

struct Result {
  int exit_code = -1;  ///< -1 if a signal ended it
  int signal = 0;
  bool timed_out = false;
  std::string out, err;
  double processor_s = 0;  ///< of all its threads
  double peak_mib = 0;     ///< resident memory
  long page_faults = 0;    ///< pages of memory that it was given

  /// The lines of stderr.
  std::vector<std::string> err_lines() const;
  /// stderr without the warnings that a live run gives where a slow or busy machine has frames late.
  std::string err_without_lateness() const;
};

/// `arguments` without the program's own name. If it is one of palpa's, the result is checked by expect_orderly.
Result run_program(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                   const RunOptions& options = {});
struct StartOptions {
  Environment environment;
  int out = 1;              ///< the program's stdout
  int err = 2;              ///< its stderr
  bool foreground = false;  ///< stderr is its terminal, and it runs in the foreground
};
/// Starts a program as a shell would, with an empty stdin, and returns its process.
pid_t start_program(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                    const StartOptions& options = {});
/// Tells palpa where its assets are: a build folder may lie outside the source tree, where palpa does not find them by
/// itself.
Environment::value_type where_assets_are();
/// The path of this build's `palpa`.
std::string palpa_binary();
Result palpa(const std::vector<std::string>& arguments, const RunOptions& options = {});

/// What names in a text stand for.
using Names = std::vector<std::pair<std::string, std::string>>;
/// The words of a text; in each, the first of these names that it has is replaced.
std::vector<std::string> words_of(const std::string& text, const Names& names = {});
/// A command line with further arguments.
std::vector<std::string> with(std::vector<std::string> arguments, const std::vector<std::string>& more);

/// Options of a live loop that may see anything as long as it sees the fingertip: frames of small_rig.toml without
/// noise, which cost a twelfth of the paper's.
std::vector<std::string> small_frames();

/// Every file and folder below a folder, with the file's bytes.
std::map<std::string, std::string> contents_of(const std::filesystem::path& folder);

/// gtest: what holds for every run of palpa that no signal ended. Its stderr is printable UTF-8 with at most one line
/// of error, and the exit code is 0 if and only if there is none. With --log-level quiet, there never is one.
void expect_orderly(const Result& result, const std::vector<std::string>& arguments);

/// gtest: the program ended well. Returns the same result.
Result succeeded(Result result);
/// gtest: the program failed with `code`, printed one line of error that contains `part` (and maybe that frames were
/// late), and printed no result.
void expect_failure(const Result& result, int code, const std::string& part);

}  // namespace palpa::test
