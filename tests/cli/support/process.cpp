#include "cli/support/process.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>
#include <cstdint>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <map>
#include <sstream>
#include <stdexcept>

#include "base/text.hpp"
#include "support/files.hpp"
#include "support/shared_data.hpp"

namespace palpa::test {
namespace {

using Clock = std::chrono::steady_clock;

/// Reads both pipes until both are closed; false when the time is up first.
bool read_both(const std::array<int, 2>& pipes, const std::array<std::string*, 2>& texts, Clock::time_point deadline) {
  std::array<pollfd, 2> polls{pollfd{pipes[0], POLLIN, 0}, pollfd{pipes[1], POLLIN, 0}};
  std::array<char, 65536> block;
  while (polls[0].fd >= 0 || polls[1].fd >= 0) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(deadline - Clock::now()).count();
    if (left <= 0) return false;
    if (poll(polls.data(), polls.size(), static_cast<int>(left)) < 0 && errno != EINTR) return false;
    for (std::size_t i = 0; i < polls.size(); ++i) {
      if (polls[i].fd < 0 || polls[i].revents == 0) continue;
      const ssize_t got = read(polls[i].fd, block.data(), block.size());
      if (got > 0) {
        texts[i]->append(block.data(), static_cast<std::size_t>(got));
      } else {
        polls[i].fd = -1;
      }
    }
  }
  return true;
}

/// This process's environment with these values, each as NAME=VALUE. The last value of a name counts.
std::vector<std::string> environment_with(const Environment& added) {
  std::map<std::string, std::string> values;
  for (char** entry = environ; *entry != nullptr; ++entry) {
    const std::string text = *entry;
    const std::size_t equals = text.find('=');
    if (equals != text.npos) values[text.substr(0, equals)] = text.substr(equals + 1);
  }
  for (const auto& [name, value] : added)
    values[name] = value;
  std::vector<std::string> texts;
  for (const auto& [name, value] : values)
    texts.push_back(name + '=' + value);
  return texts;
}

}  // namespace

std::vector<std::string> Result::err_lines() const {
  std::vector<std::string> lines;
  std::istringstream stream(err);
  for (std::string line; std::getline(stream, line);)
    lines.push_back(line);
  return lines;
}

std::string Result::err_without_lateness() const {
  std::string rest;
  for (const std::string& line : err_lines()) {
    if (line.starts_with("palpa: warning: overloaded: ") ||
        line.find(" after their capture, late or in bursts: ") != line.npos)
      continue;
    rest += line + "\n";
  }
  return rest;
}

pid_t start_program(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                    const StartOptions& options) {
  // Everything that allocates happens before the fork. If another thread holds a lock of the heap at the moment of the
  // fork, nobody releases it in the child, and AddressSanitizer does not take care of this.
  std::vector<char*> argv{const_cast<char*>(program.c_str())};
  for (const std::string& argument : arguments)
    argv.push_back(const_cast<char*>(argument.c_str()));
  argv.push_back(nullptr);
  std::vector<std::string> texts = environment_with(options.environment);
  std::vector<char*> environment;
  for (std::string& text : texts)
    environment.push_back(text.data());
  environment.push_back(nullptr);
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("no fork");
  if (child > 0) return child;

  // A test that is killed leaves no run behind that records until the disk is full.
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (options.foreground) {
    setsid();
    ioctl(options.err, TIOCSCTTY, 0);
  }
  dup2(open("/dev/null", O_RDONLY), STDIN_FILENO);
  dup2(options.out, STDOUT_FILENO);
  dup2(options.err, STDERR_FILENO);
  // A shell starts programs with these at their default.
  std::signal(SIGPIPE, SIG_DFL);
  std::signal(SIGXFSZ, SIG_DFL);
  execve(argv[0], argv.data(), environment.data());
  _exit(127);
}

Result run_program(const std::filesystem::path& program, const std::vector<std::string>& arguments,
                   const RunOptions& options) {
  std::array<int, 2> out{}, err{};
  if (pipe2(out.data(), O_CLOEXEC) != 0 || pipe2(err.data(), O_CLOEXEC) != 0) throw std::runtime_error("no pipe");
  if (options.close_stdout_reader) {
    // Before the program can write anything.
    close(out[0]);
    out[0] = -1;
  }
  const auto begin = Clock::now();
  const int file = options.stdout_file.empty() ? -1 : open(options.stdout_file.c_str(), O_WRONLY | O_CLOEXEC);
  const pid_t child = start_program(program, arguments, {options.environment, file >= 0 ? file : out[1], err[1]});
  if (file >= 0) close(file);
  close(out[1]);
  close(err[1]);
  Result result;
  const auto deadline = begin + std::chrono::microseconds(static_cast<std::int64_t>(options.timeout_s * 1e6));
  if (!read_both({out[0], err[0]}, {&result.out, &result.err}, deadline)) {
    result.timed_out = true;
    kill(child, SIGKILL);
  }
  int status = 0;
  rusage usage{};
  while (wait4(child, &status, 0, &usage) < 0 && errno == EINTR) {
  }
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
  };
  result.processor_s = seconds(usage.ru_utime) + seconds(usage.ru_stime);
  result.peak_mib = static_cast<double>(usage.ru_maxrss) / 1024;
  result.page_faults = usage.ru_minflt;
  if (WIFEXITED(status)) result.exit_code = WEXITSTATUS(status);
  if (WIFSIGNALED(status)) result.signal = WTERMSIG(status);
  if (out[0] >= 0) close(out[0]);
  close(err[0]);
  if (const std::string name = program.filename(); name == "palpa" || name == "palpa-viewer")
    expect_orderly(result, arguments);
  return result;
}

void expect_orderly(const Result& result, const std::vector<std::string>& arguments) {
  if (result.timed_out || result.exit_code < 0) return;
  std::string line;
  for (const std::string& argument : arguments)
    line += ' ' + printable(argument, 80);
  SCOPED_TRACE(line);
  int errors = 0;
  bool foreign = false;
  for (const std::string& told : result.err_lines()) {
    if (!told.starts_with("palpa")) {  // of the system, of the loader
      foreign = true;
      continue;
    }
    EXPECT_EQ(printable(told), told) << "it is not UTF-8, or not printable";
    // Vulkan's validation may find several faults.
    errors += told.starts_with("palpa: error: ") && !told.starts_with("palpa: error: Vulkan validation: ") ? 1 : 0;
  }
  EXPECT_LE(errors, 1) << result.err;
  const auto quiet = std::ranges::find(arguments, "--log-level");
  if (quiet != arguments.end() && quiet + 1 != arguments.end() && quiet[1] == "quiet") return;
  if (foreign && errors == 0) return;
  EXPECT_EQ(result.exit_code == 0, errors == 0) << "exit code " << result.exit_code << ": " << result.err;
}

std::string palpa_binary() {
  return PALPA_BINARY;
}

Environment::value_type where_assets_are() {
  return {"PALPA_ASSETS", source_file("assets").string()};
}

Result palpa(const std::vector<std::string>& arguments, const RunOptions& options) {
  RunOptions with_assets = options;
  with_assets.environment.insert(with_assets.environment.begin(), where_assets_are());
  return run_program(palpa_binary(), arguments, with_assets);
}

std::vector<std::string> words_of(const std::string& text, const Names& names) {
  std::istringstream in(text);
  std::vector<std::string> words;
  for (std::string word; in >> word;) {
    const auto named = std::ranges::find_if(names, [&](const auto& n) { return word.find(n.first) != word.npos; });
    if (named != names.end()) word.replace(word.find(named->first), named->first.size(), named->second);
    words.push_back(word);
  }
  return words;
}

std::vector<std::string> with(std::vector<std::string> arguments, const std::vector<std::string>& more) {
  arguments.insert(arguments.end(), more.begin(), more.end());
  return arguments;
}

std::vector<std::string> small_frames() {
  return {"--rig", source_file("tests/cli/support/small_rig.toml").string(), "--noise-free"};
}

std::map<std::string, std::string> contents_of(const std::filesystem::path& folder) {
  std::map<std::string, std::string> all;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
    all[entry.path().lexically_relative(folder)] = entry.is_regular_file() ? read_text(entry.path()) : "";
  return all;
}

Result succeeded(Result result) {
  EXPECT_EQ(result.exit_code, 0) << result.err;
  return result;
}

void expect_failure(const Result& result, int code, const std::string& part) {
  EXPECT_EQ(result.exit_code, code) << result.err;
  EXPECT_EQ(result.signal, 0);
  EXPECT_FALSE(result.timed_out);
  EXPECT_EQ(result.out, "");
  const std::string line = result.err_without_lateness();
  ASSERT_EQ(std::ranges::count(line, '\n'), 1) << result.err;
  EXPECT_TRUE(line.starts_with("palpa: error: ")) << line;
  EXPECT_NE(line.find(part), std::string::npos) << line << "does not contain: " << part;
  EXPECT_EQ(result.err.back(), '\n');
}

}  // namespace palpa::test
