#include "cli/support/live_run.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <thread>

#include "cli/support/delays.hpp"
#include "cli/support/process.hpp"
#include "support/files.hpp"

namespace palpa::test {
namespace {

using Clock = std::chrono::steady_clock;

/// Whether its first thread has ended, and with it the program. What comes after that is the system's, which takes the
/// memory down in the name of the thread that is last: Mesa's for its cache has the lowest priority.
bool has_ended(pid_t child) {
  const std::string stat = read_text("/proc/" + std::to_string(child) + "/stat");  // PID (NAME) STATE ...
  const std::size_t name_end = stat.rfind(") ");
  return name_end == std::string::npos || stat[name_end + 2] == 'Z' || stat[name_end + 2] == 'X';
}

}  // namespace

Unread Unread::pipe() {
  std::array<int, 2> ends{};
  EXPECT_EQ(pipe2(ends.data(), O_CLOEXEC), 0);
  // Filled to the brim without waiting; a later writer waits as usual.
  fcntl(ends[1], F_SETFL, O_NONBLOCK);
  const std::string dots(4096, '.');
  while (write(ends[1], dots.data(), dots.size()) > 0) {
  }
  fcntl(ends[1], F_SETFL, 0);
  return {ends[1], ends[0]};
}

Unread Unread::terminal() {
  int master = -1, slave = -1;
  EXPECT_EQ(openpty(&master, &slave, nullptr, nullptr, nullptr), 0);
  fcntl(master, F_SETFD, FD_CLOEXEC);
  fcntl(slave, F_SETFD, FD_CLOEXEC);
  return {slave, master};
}

Unread Unread::file(const std::string& name) {
  const int end = open(name.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
  EXPECT_GE(end, 0) << name;
  return {end, -1};
}

Unread::Unread(Unread&& other) noexcept
    : end_(std::exchange(other.end_, -1)), other_(std::exchange(other.other_, -1)) {}

Unread::~Unread() {
  if (end_ >= 0) close(end_);
  if (other_ >= 0) close(other_);
}

void Unread::stop() {
  const char ctrl_s = 0x13;
  EXPECT_EQ(write(other_, &ctrl_s, 1), 1);
}

std::string Unread::read_all() {
  fcntl(other_, F_SETFL, O_NONBLOCK);
  std::string text;
  std::array<char, 4096> block;
  for (ssize_t got; (got = read(other_, block.data(), block.size())) > 0;)
    text.append(block.data(), static_cast<std::size_t>(got));
  return text;
}

LiveRun::LiveRun(const std::vector<std::string>& arguments, const LiveOptions& options) {
  std::vector<std::string> line;
  if (options.program.empty()) line.emplace_back(options.command);
  line.insert(line.end(), arguments.begin(), arguments.end());
  const int nothing = open("/dev/null", O_WRONLY | O_CLOEXEC);
  StartOptions start{options.environment, nothing, nothing, options.foreground};
  start.environment.push_back(where_assets_are());
  if (options.out) start.out = options.out->end();
  if (options.err) start.err = options.err->end();
  child_ = start_program(options.program.empty() ? palpa_binary() : options.program, line, start);
  close(nothing);
}

LiveRun::~LiveRun() {
  if (child_ <= 0) return;
  kill(child_, SIGKILL);
  waitpid(child_, nullptr, 0);
}

void LiveRun::signal(int signal) const {
  if (child_ > 0) kill(child_, signal);
}

LiveRun::End LiveRun::wait(double at_most_s) {
  if (end_.ended) return end_;
  const auto begin = Clock::now();
  Delays delays({child_});
  End end;
  int status = 0;
  double waited_s = 0;
  do {
    end.ended = has_ended(child_);
    waited_s = std::chrono::duration<double>(Clock::now() - begin).count();
    delays.look();
    if (!end.ended) std::this_thread::sleep_for(std::chrono::milliseconds(2));
  } while (!end.ended && waited_s < at_most_s);
  end.held_up_s = delays.sum_s();
  end.after_s = waited_s - end.held_up_s;
  if (!end.ended) return end;
  waitpid(child_, &status, 0);
  child_ = -1;
  if (WIFEXITED(status)) end.exit_code = WEXITSTATUS(status);
  if (WIFSIGNALED(status)) end.by_signal = WTERMSIG(status);
  return end_ = end;
}

}  // namespace palpa::test
