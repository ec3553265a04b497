// The end of an emulator: Ctrl-C, SIGTERM, a terminal that is closed.
#pragma once

#include <atomic>
#include <csignal>

namespace palpa::driver::emulate {

/// While a Stop exists, these signals only make asked() true. There may be one at a time.
class Stop {
 public:
  Stop();
  ~Stop();
  Stop(const Stop&) = delete;
  Stop& operator=(const Stop&) = delete;
  static const std::atomic<bool>& asked();
  /// Does what a signal would do.
  static void ask();

 private:
  struct sigaction before_[4];
};

}  // namespace palpa::driver::emulate
