// What a source of cameras needs from the machine: waiting, background work, and the time. A test has its own.
#pragma once

#include <poll.h>

#include <functional>
#include <future>
#include <span>

namespace palpa::driver::cameras {

class Host {
 public:
  virtual ~Host() = default;
  /// Fills in `revents`. Returns the number of descriptors that have any, or -errno, but never -EINTR.
  virtual int poll(std::span<pollfd> descriptors, double timeout_s);
  /// Does `work` on its own thread. The future is ready when that is done.
  virtual std::future<void> beside(std::function<void()> work);
  /// CLOCK_MONOTONIC, which capture times are on.
  virtual double now_s();
};

}  // namespace palpa::driver::cameras
