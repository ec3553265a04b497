// Signals that ask palpa to end. They set a flag that the working code checks.
#pragma once

#include <atomic>
#include <csignal>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace palpa::setup {

/// While an object of this class exists, signals only set flag(). Signals that palpa's parent process
/// ignores (nohup) stay ignored. Only one object may exist at a time.
class Interrupt {
 public:
  /// Must exist for as long as there is something to silence. Catches all signals that end or stop a program and can be
  /// caught, including Ctrl-Z, because a stopped program cannot silence anything. Further signals have no effect, so an
  /// impatient second Ctrl-C cannot leave the array sounding. After signals other than SIGINT, SIGTERM, SIGHUP, SIGQUIT
  /// and SIGTSTP, such as SIGXCPU, the program ends as failed, with a line that names them. One second after the first
  /// signal, palpa ends in any case, with the error line `late`; no output and no device can delay it longer. This also
  /// holds for work after this object's end. `came` is called on another thread when the first signal comes, while this
  /// object lives; it must not wait.
  explicit Interrupt(std::string late, std::function<void()> came = {});

  ~Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;

  /// Whether a signal came, whatever has happened to the flag since.
  static bool signalled();
  /// Sets a function that is called on another thread before palpa ends by itself one second after a signal; nullptr:
  /// none. It must not wait.
  static void at_the_end(void (*restore)());
  /// The flag itself, which other code may also set.
  static std::atomic<bool>& flag();

 private:
  struct Deadline;
  void replace(int signal, const struct sigaction& action);

  std::vector<std::pair<int, struct sigaction>> before_;
  std::shared_ptr<Deadline> deadline_;  ///< shared with its thread, which continues after a signal
  std::thread watch_;
};

}  // namespace palpa::setup
