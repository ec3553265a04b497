// A running palpa, until the test has seen enough, and its whole output.
#pragma once

#include <gtest/gtest.h>

#include <csignal>
#include <filesystem>
#include <string>
#include <vector>

#include "cli/support/live_run.hpp"
#include "cli/support/process.hpp"
#include "support/files.hpp"
#include "support/shared_data.hpp"

namespace palpa::test {

class Loop {
 public:
  /// palpa COMMAND ARGUMENTS...
  Loop(const char* command, const std::vector<std::string>& arguments)
      : said_(scratch_folder("loop") / "stderr.txt"),
        err_(Unread::file(said_)),
        run_(arguments, options(command, err_)) {}

  void signal(int signal) const { run_.signal(signal); }
  std::string said() const { return read_text(said_); }
  /// Acts like Ctrl-C; returns the exit code, -1 if it does not end.
  int end() {
    signal(SIGINT);
    return wait();
  }
  int wait() { return run_.wait(60).exit_code; }

 private:
  static LiveOptions options(const char* command, const Unread& err) {
    LiveOptions options;
    options.err = &err;
    options.command = command;
    return options;
  }

  std::filesystem::path said_;
  Unread err_;
  LiveRun run_;
};

/// For `palpa link`: every 60 ms the next transducer, for 15 seconds.
inline std::vector<std::string> sweep_of(const std::string& link, const std::string& layout = "openmpd") {
  return {"test", "--layout", layout, "--link", link, "--each", "50ms", "--rest", "10ms", "--dwell", "10ms"};
}

/// Runs as another user of the guest, "NAME" or "NAME:GROUP".
inline Result palpa_as(const std::string& user, const std::vector<std::string>& arguments) {
  const std::vector<std::string> line{"start-stop-daemon", "-S", "-q", "-c", user, "-x", palpa_binary(), "--"};
  return run_program("/bin/busybox", with(line, arguments), {.environment = {where_assets_are()}});
}

}  // namespace palpa::test
