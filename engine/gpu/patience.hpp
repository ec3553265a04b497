// How long to wait for a device. A GPU computes by itself, and the clock on the wall says how long it has had. A device
// that is software has only what this machine's processors leave it: ten programs that start at once may wait for
// minutes without anything being wrong. So there the processor time of the driver's threads counts, and whether they
// still get on.
#pragma once

#include <volk.h>

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "gpu/device.hpp"

namespace palpa::gpu {

/// What a thread has done so far.
struct ThreadWork {
  double processor_s = 0;
  bool may_run = false;  ///< it computes, waits for a processor that is free, or for a disk
};

/// Ids of this process's threads.
std::vector<int> threads_of_process();
/// In the same order; nothing done where there is no such thread any more.
std::vector<ThreadWork> work_of(std::span<const int> threads);

/// Decides when a device has been waited for in vain.
class Patience {
 public:
  /// `limit_s`: seconds of the wall clock for a GPU; with `software`, seconds of processor time of the busiest of the
  /// driver's threads, or seconds of the wall clock in which none of them does anything.
  Patience(double limit_s, bool software) : limit_s_(limit_s), software_(software) {}

  /// For how long to wait before the next look.
  double slice_s() const;
  /// Called after each wait in vain, which took `waited_s`, with what the driver's threads have done; true when it is
  /// enough. A wait that took much longer than a slice counts as two: this program did not run then either.
  bool ends(double waited_s, std::span<const ThreadWork> threads);
  /// After that: what was waited for.
  std::string reason() const;

 private:
  double limit_s_;
  bool software_;
  double waited_s_ = 0;  ///< of a software device: without any progress
  std::vector<ThreadWork> first_, last_;
};

/// Calls `wait` with nanoseconds until it returns something else than VK_TIMEOUT. Where the device does not answer, it
/// counts as lost and as abandoned (gpu/handle.hpp) from then on, and failure() is thrown.
VkResult wait_patiently(const Device& device, double limit_s, const std::function<VkResult(std::uint64_t)>& wait);

}  // namespace palpa::gpu
