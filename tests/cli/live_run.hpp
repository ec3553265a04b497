// `palpa run`, another of its commands or another program, while it lives: nobody reads what it writes.
#pragma once

#include <sys/types.h>

#include <string>
#include <utility>
#include <vector>

#include "process.hpp"

namespace palpa::test {

/// What takes no more, or may not: a pipe, a terminal, a file.
class Unread {
 public:
  /// A pipe, full and never read.
  static Unread pipe();
  /// A terminal that Ctrl-S will stop.
  static Unread terminal();
  /// A file, on a disk that may stop answering.
  static Unread file(const std::string& name);
  Unread(Unread&& other) noexcept;
  Unread& operator=(Unread&&) = delete;
  ~Unread();

  int end() const { return end_; }
  /// Ctrl-S.
  void stop();
  /// All that has been written so far; the pipe takes more then.
  std::string read_all();

 private:
  Unread(int end, int other) : end_(end), other_(other) {}
  int end_ = -1;    ///< the program's
  int other_ = -1;  ///< ours
};

struct LiveOptions {
  const Unread* out = nullptr;  ///< stdout; else /dev/null
  const Unread* err = nullptr;  ///< stderr; else /dev/null
  bool foreground = false;      ///< `err` is the terminal that it runs on
  Environment environment{};
  const char* command = "run";
  std::string program{};  ///< in palpa's place; without a command
};

class LiveRun {
 public:
  /// palpa, or that program, with these arguments.
  explicit LiveRun(const std::vector<std::string>& arguments, const LiveOptions& options = {});
  ~LiveRun();  ///< kills what is left
  LiveRun(const LiveRun&) = delete;
  LiveRun& operator=(const LiveRun&) = delete;

  pid_t id() const { return child_; }
  void signal(int signal) const;

  struct End {
    bool ended = false;  ///< in time
    int exit_code = -1;  ///< -1 where a signal ended it
    int by_signal = 0;
    double after_s = 0;  ///< since this was asked
  };
  /// For the program's end, which is its first thread's: not for the system, which takes its memory down after that.
  End wait(double at_most_s);

 private:
  pid_t child_ = -1;
};

}  // namespace palpa::test
