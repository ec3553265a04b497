// The end of an emulator: Ctrl-C, SIGTERM, a terminal that is closed.
#pragma once

#include <atomic>
#include <csignal>

namespace palpa::driver::emulate {

/// While it lives these signals only make asked() true. One at a time.
class Stop {
 public:
  Stop();
  ~Stop();
  Stop(const Stop&) = delete;
  Stop& operator=(const Stop&) = delete;
  static const std::atomic<bool>& asked();
  /// As a signal would.
  static void ask();

 private:
  struct sigaction before_[4];
};

}  // namespace palpa::driver::emulate
