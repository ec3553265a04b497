// Signals that ask palpa to end: they set a flag, and whoever works looks at it.
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

/// From its construction until its end signals only make requested() true; those that whoever started palpa ignores
/// (nohup) stay ignored. One at a time.
class Interrupt {
 public:
  /// For as long as there is something to silence: all signals that end or stop a program and can be caught, Ctrl-Z
  /// too, since a program that is stopped cannot silence anything. Later ones change nothing: the array must not be
  /// left sounding by an impatient second Ctrl-C. But a second after the first one palpa ends whatever it is doing,
  /// with the error line `late`: nothing that it writes to, and no device, keeps it longer. That goes for what is done
  /// after this object's end, too. `came` is called on another thread when the first signal has come, for as long as
  /// this object lives; it must not wait.
  explicit Interrupt(std::string late, std::function<void()> came = {});

  ~Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;

  bool requested() const { return flag(); }
  /// A signal came, whatever has become of the flag since.
  static bool signalled();
  /// What is called, on another thread, before palpa ends by itself a second after a signal; nullptr: nothing. It must
  /// not wait.
  static void at_the_end(void (*restore)());
  /// The flag itself, which others may set as well.
  static std::atomic<bool>& flag();

 private:
  struct Deadline;
  void replace(int signal, const struct sigaction& action);

  std::vector<std::pair<int, struct sigaction>> before_;
  std::shared_ptr<Deadline> deadline_;  ///< its thread's, too, which lives on after a signal
  std::thread watch_;
};

}  // namespace palpa::setup
