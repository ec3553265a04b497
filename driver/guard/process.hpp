// A guard as its loop sees it: the loop starts it, feeds it and waits for it.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/system/descriptor.hpp"
#include "base/system/kept_from_forks.hpp"
#include "driver/guard/brief.hpp"
#include "driver/guard/channel.hpp"

namespace palpa::driver {

/// The path of the `palpa-guard` that belongs to the running program: the first of the places of look_for_guard_at(),
/// beside the program in a build tree, in libexec when installed. Throws failure(), naming these places, if there is
/// none.
std::string guard_program();
/// For a library in a program that is not palpa's, such as the Python module.
void look_for_guard_at(std::vector<std::string> places);

class GuardProcess {
 public:
  /// Starts `program` in its own process session. It inherits only its ends of socket and memory, and the working
  /// directory. For a board that plays plans of up to `most_cycle` drives. Throws failure() if it does not start.
  GuardProcess(const std::string& program, const Brief& brief, std::uint32_t most_cycle);
  /// Hangs up, wakes the guard, and waits for its exit.
  ~GuardProcess();
  GuardProcess(const GuardProcess&) = delete;
  GuardProcess& operator=(const GuardProcess&) = delete;

  pid_t id() const { return child_; }
  int socket() const { return socket_.get(); }
  const SharedMemory& memory() const { return memory_; }

  /// Tells the guard that the loop has ended. Its messages can still be heard.
  void hang_up();
  /// wake() continues a guard that was stopped. kill() ends it at once, whatever it does.
  void wake() const;
  void kill() const;
  /// Waits until the guard has a message or is gone. Returns false if neither happens within `at_most_s`.
  bool wait_for_word(double at_most_s) const;
  struct Exit {
    bool ended = false;  ///< in time
    int code = -1;       ///< -1 if a signal ended it, or if it is not known
    int by_signal = 0;
  };
  Exit wait_for_exit(double at_most_s);

 private:
  SharedMemory memory_;
  Descriptor socket_, child_handle_;
  /// Otherwise a process that fork() made would keep the guard, and the guard its board, when this one is gone.
  std::optional<KeptFromForks> kept_socket_;
  pid_t child_ = -1;
  Exit exit_;
};

}  // namespace palpa::driver
