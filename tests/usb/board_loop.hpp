// A program that has a board play one transducer after the other, as long as one likes.
#pragma once

#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <string>
#include <vector>

#include "cli/live_run.hpp"
#include "support/files.hpp"
#include "support/shared_data.hpp"

namespace palpa::test {

/// What `palpa link test` is told: every 60 ms the next transducer, for a quarter of a minute.
inline std::vector<std::string> sweep_of(const std::string& link) {
  return {"test", "--layout", "openmpd", "--link", link, "--each", "50ms", "--rest", "10ms", "--dwell", "10ms"};
}

class BoardLoop {
 public:
  explicit BoardLoop(const std::string& link)
      : said_(scratch_folder("loop") / "stderr.txt"), err_(Unread::file(said_)), run_(sweep_of(link), options(err_)) {}

  void signal(int signal) const { run_.signal(signal); }
  pid_t id() const { return run_.id(); }
  std::string said() const { return read_text(said_); }
  /// As Ctrl-C; its exit code, -1 where it does not end.
  int end() {
    signal(SIGINT);
    return wait();
  }
  int wait() { return run_.wait(5).exit_code; }

 private:
  static LiveOptions options(const Unread& err) {
    LiveOptions options;
    options.err = &err;
    options.command = "link";
    return options;
  }

  std::filesystem::path said_;
  Unread err_;
  LiveRun run_;
};

}  // namespace palpa::test
