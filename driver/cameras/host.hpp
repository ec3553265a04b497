// What a source of cameras asks of the machine: to wait, to have something done beside it, the time. A test has its
// own.
#pragma once

#include <poll.h>

#include <functional>
#include <future>
#include <span>

namespace palpa::driver::cameras {

class Host {
 public:
  virtual ~Host() = default;
  /// Fills in `revents`; the number of descriptors that have any, or -errno, never -EINTR.
  virtual int poll(std::span<pollfd> descriptors, double timeout_s);
  /// Does that on a thread of its own. Ready when it is done.
  virtual std::future<void> beside(std::function<void()> work);
  /// CLOCK_MONOTONIC, which capture times are on.
  virtual double now_s();
};

}  // namespace palpa::driver::cameras
