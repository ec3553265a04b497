// A guard as its loop sees it: started, fed, waited for.
#pragma once

#include <sys/types.h>

#include <cstdint>
#include <span>
#include <string>

#include "driver/guard/brief.hpp"
#include "driver/guard/channel.hpp"

namespace palpa::driver {

/// Where the `palpa-guard` that belongs to the running program lies: beside it in a build tree, in libexec when
/// installed. Throws failure() where there is none.
std::string guard_program();

class GuardProcess {
 public:
  /// Starts `program` in a session of its own; it inherits nothing but the two ends here and the working directory. For
  /// a board that plays plans of up to `most_cycle` drives. Throws failure() where it does not start.
  GuardProcess(const std::string& program, const Brief& brief, std::uint32_t most_cycle);
  /// Ends the socket, and waits for its exit as end() does.
  ~GuardProcess();
  GuardProcess(const GuardProcess&) = delete;
  GuardProcess& operator=(const GuardProcess&) = delete;

  pid_t id() const { return child_; }
  int socket() const { return socket_.get(); }
  const SharedMemory& memory() const { return memory_; }

  /// Tells it that the loop is at its end. What it says can still be heard.
  void hang_up();
  /// Lets it go on where it was stopped; and ends it at once, whatever it does.
  void wake() const;
  void kill() const;
  /// Waits until it has something to say, or is gone. False: not within `at_most_s`.
  bool wait_for_word(double at_most_s) const;
  struct Exit {
    bool ended = false;  ///< in time
    int code = -1;       ///< -1 where a signal ended it, or nobody knows
    int by_signal = 0;
  };
  Exit wait_for_exit(double at_most_s);

 private:
  SharedMemory memory_;
  Descriptor socket_, child_handle_;
  pid_t child_ = -1;
  Exit exit_;
};

}  // namespace palpa::driver
