// A link to a board that records its commands, held by a guard of the tests' own; and a loop that may be killed.
#pragma once

#include <gtest/gtest.h>
#include <sys/types.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "base/log.hpp"
#include "driver/guard/board_link.hpp"
#include "session/links/link.hpp"
#include "support/begins.hpp"
#include "support/shared_data.hpp"
#include "trace_board.hpp"

namespace palpa::test {

inline void wait(std::chrono::microseconds time) {
  std::this_thread::sleep_for(time);
}

/// A link to a board that records its commands.
struct GuardRig {
  array::Layout layout;
  std::vector<std::string> names;
  std::filesystem::path file = scratch_folder("guard") / "trace";
  session::LinkSetting setting{layout, names, 1.5e-3};
  array::Drive drive;
  std::uint64_t slot = 0;  ///< the next
  std::unique_ptr<session::Link> link;

  explicit GuardRig(std::size_t transducers = 249) : drive(transducers) {
    layout.name = "some";
    layout.transducers.assign(transducers, {Vec3(0), Vec3(0, 0, 1)});
  }
  std::unique_ptr<session::Link> open(const std::string& argument) const {
    const auto guard = std::filesystem::read_symlink("/proc/self/exe").parent_path() / "palpa-trace-guard";
    return driver::board_link({"trace", "trace:FILE", {}, true}, guard.string()).open(argument, setting);
  }
  void open() { link = open(file.string()); }
  void send(std::uint64_t s) {
    whole_drive(s, drive);
    link->send(s, drive);
  }
  void send_for(std::chrono::milliseconds time) {
    for (const auto end = std::chrono::steady_clock::now() + time; std::chrono::steady_clock::now() < end;
         wait(std::chrono::microseconds(1500)))
      send(slot++);
  }
  /// Opens it; a first drive is played.
  void begin() {
    open();
    send(slot++);
    ASSERT_TRUE(wrote("play 0"));
  }
  void plan(std::uint64_t from, std::uint32_t cycle) {
    array::Schedule schedule;
    schedule.add_voice().foci = {Vec3(0)};
    array::Drive drives(cycle * drive.size());
    link->plan({.schedule = schedule, .slots = {from, from + 66, {session::Plays::pattern, cycle}}, .drives = drives});
  }

  std::vector<std::string> lines() const {
    std::vector<std::string> all;
    std::ifstream in(file);
    for (std::string line; std::getline(in, line);)
      all.push_back(line);
    return all;
  }
  std::size_t count(const std::string& begin) const {
    std::size_t found = 0;
    for (const std::string& line : lines())
      found += line.starts_with(begin) ? 1 : 0;
    return found;
  }
  /// Waits until this many lines begin with `begin`.
  bool wrote(const std::string& begin, std::size_t times = 1) const {
    return begins([&] { return count(begin) >= times; });
  }
  /// Waits until `line` is its last line.
  bool ends_with(const std::string& line) const {
    return begins([&] {
      const std::vector<std::string> all = lines();
      return !all.empty() && all.back() == line;
    });
  }
  void expect_silent_end() const {
    const std::vector<std::string> all = lines();
    ASSERT_GE(all.size(), 3u);
    EXPECT_EQ(all[0], "open");
    EXPECT_EQ(all[all.size() - 2], "off");
    EXPECT_EQ(all[all.size() - 1], "close");
    EXPECT_EQ(count("torn"), 0u);
    EXPECT_EQ(count("allocated"), 0u);
  }
  /// What an end says of the board after that.
  std::string is_silent() const { return "the array (trace:" + file.string() + ") is silent"; }
  void end_silent() {
    link->finish();
    expect_silent_end();
  }
};

/// A loop in a separate process, which a test may stop, continue and kill.
class ForkedLoop {
 public:
  /// `loop` runs until the process is killed, and prints nothing.
  explicit ForkedLoop(const std::function<void()>& loop) : id_(fork()) {
    if (id_ != 0) return;
    log::set_level(log::Level::quiet);
    try {
      loop();
    } catch (...) {  // otherwise, this process would go on with the tests that follow
    }
    _exit(1);
  }
  ~ForkedLoop() { end(SIGKILL); }
  ForkedLoop(const ForkedLoop&) = delete;
  ForkedLoop& operator=(const ForkedLoop&) = delete;
  void signal(int which) const { kill(id_, which); }
  /// Whether it has ended by itself.
  bool ended() {
    if (id_ > 0 && waitpid(id_, nullptr, WNOHANG) == id_) id_ = -1;
    return id_ <= 0;
  }
  void end(int by) {
    if (id_ <= 0) return;
    kill(id_, by);
    waitpid(id_, nullptr, 0);
    id_ = -1;
  }

 private:
  pid_t id_;
};

/// Stops a guard of this process. Returns when it has stopped: until then, it may still take a drive.
inline void stop(pid_t guard) {
  kill(guard, SIGSTOP);
  siginfo_t stopped{};
  EXPECT_EQ(waitid(P_PID, static_cast<id_t>(guard), &stopped, WSTOPPED | WNOWAIT), 0);
}

/// The guard that this process started last.
inline pid_t guard_of_ours() {
  const std::string task = "/proc/self/task/" + std::to_string(getpid()) + "/children";
  std::ifstream in(task);
  pid_t child = -1, last = -1;
  while (in >> child)
    last = child;
  return last;
}

}  // namespace palpa::test
