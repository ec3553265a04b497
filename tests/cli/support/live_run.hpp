// A running `palpa run`, another command of palpa or another program, whose output nobody reads.
#pragma once

#include <sys/types.h>

#include <string>
#include <utility>
#include <vector>

#include "cli/support/delays.hpp"
#include "cli/support/process.hpp"

namespace palpa::test {

/// An output that takes nothing more, or may stop to: a pipe, a terminal, a file.
class Unread {
 public:
  /// A pipe, full and never read.
  static Unread pipe();
  /// A terminal that Ctrl-S can stop.
  static Unread terminal();
  /// A file, on a disk that may stop responding.
  static Unread file(const std::string& name);
  Unread(Unread&& other) noexcept;
  Unread& operator=(Unread&&) = delete;
  ~Unread();

  int end() const { return end_; }
  /// Ctrl-S.
  void stop();
  /// Everything written so far; afterwards, the pipe takes more.
  std::string read_all();

 private:
  Unread(int end, int other) : end_(end), other_(other) {}
  int end_ = -1;    ///< the program's
  int other_ = -1;  ///< the test's
};

struct LiveOptions {
  const Unread* out = nullptr;  ///< stdout; else /dev/null
  const Unread* err = nullptr;  ///< stderr; else /dev/null
  bool foreground = false;      ///< `err` is its terminal, and it runs in the foreground
  Environment environment{};
  const char* command = "run";
  std::string program{};  ///< instead of palpa; without a command
};

class LiveRun {
 public:
  /// Starts palpa, or that program, with these arguments.
  explicit LiveRun(const std::vector<std::string>& arguments, const LiveOptions& options = {});
  ~LiveRun();  ///< kills remaining processes
  LiveRun(const LiveRun&) = delete;
  LiveRun& operator=(const LiveRun&) = delete;

  pid_t id() const { return child_; }
  void signal(int signal) const;

  struct End {
    bool ended = false;  ///< within the time limit
    int exit_code = -1;  ///< -1 if a signal ended it
    int by_signal = 0;
    double after_s = 0;  ///< since the call, without the time in which a thread was ready and got no processor
    /// Its exit code is 0, or 1 where it told of a busy machine's delay: that it did not get everything done in time.
    bool in_order() const { return exit_code == 0 || (exit_code == 1 && held_up_s > delay_that_is_told_s); }
    double held_up_s = 0;  ///< that time, of all its threads together
  };
  /// Waits for the program's end, which is the end of its first thread. The system frees the program's memory only
  /// after that; this is not waited for. Once it has ended, every further call returns the same.
  End wait(double at_most_s);

 private:
  pid_t child_ = -1;
  End end_{};  ///< once the program has ended
};

}  // namespace palpa::test
