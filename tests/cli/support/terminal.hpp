// The real program in the foreground of its own terminal, as a person runs it.
#pragma once

#include <sys/types.h>

#include <optional>
#include <string>
#include <vector>

#include "cli/support/delays.hpp"

namespace palpa::test {

class Terminal {
 public:
  /// `palpa` with these arguments.
  explicit Terminal(const std::vector<std::string>& arguments);
  /// Another program, found like a shell finds it. The terminal has 80 columns, whatever the environment says.
  Terminal(const std::string& program, const std::vector<std::string>& arguments);
  /// Ends the program if it has not ended.
  ~Terminal();
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  /// Waits, at most two minutes, until the program's output contains `part`.
  bool shows(const std::string& part);
  /// Keys; "\x03" is Ctrl-C.
  void type(const std::string& keys);
  /// The signal that ended the program; 0 if it ended by itself. Waits for the end.
  int ended_by_signal();
  /// Whether palpa ended one second after the last key without finishing, on a machine that delayed it: see
  /// LiveRun::End::in_order.
  bool cut_short() const;
  /// Processor time of all its threads from the last key to its end, once it has ended. Unlike the time on a clock, it
  /// is not longer on a busy machine.
  double processor_s_to_end() const { return processor_s_; }
  const std::string& text() const { return text_; }

 private:
  /// Waits a little for output; false once there will be no more.
  bool read_some();

  int master_ = -1;
  pid_t child_ = 0;
  double processor_s_ = 0;
  int exit_code_ = -1;
  std::optional<Delays> delays_;  ///< since the last key
  std::string text_;
};

}  // namespace palpa::test
