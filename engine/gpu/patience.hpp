// How long to wait for a device. A GPU computes by itself, so the wall clock measures its time. A software device only
// has what the machine's processors leave for it: ten programs that start at once may wait for minutes without any
// fault. For software devices, the limit therefore counts the processor time of the driver's threads, and whether they
// make progress.
#pragma once

#include <volk.h>

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "gpu/device.hpp"

namespace palpa::gpu {

/// The work that a thread has done so far.
struct ThreadWork {
  double processor_s = 0;
  bool may_run = false;  ///< it computes, or waits for a free processor or for a disk
};

/// Ids of this process's threads.
std::vector<int> threads_of_process();
/// In the same order; zero work for a thread that no longer exists.
std::vector<ThreadWork> work_of(std::span<const int> threads);

/// Decides when to give up waiting for a device.
class Patience {
 public:
  /// `limit_s`: for a GPU, seconds of the wall clock; with `software`, seconds of processor time of the busiest of the
  /// driver's threads, or seconds of the wall clock during which no thread of the driver does anything.
  Patience(double limit_s, bool software) : limit_s_(limit_s), software_(software) {}

  /// How long to wait before the next check.
  double slice_s() const;
  /// Call after each unsuccessful wait, which took `waited_s`, with the work of the driver's threads. Returns true if
  /// the limit is reached. A wait that took much longer than a slice counts as two slices, because this program did not
  /// run during the rest of it either.
  bool ends(double waited_s, std::span<const ThreadWork> threads);
  /// After the end: what was waited for.
  std::string reason() const;

 private:
  double limit_s_;
  bool software_;
  double waited_s_ = 0;  ///< for a software device: time without any progress
  std::vector<ThreadWork> first_, last_;
};

/// Calls `wait` with nanoseconds until it returns something other than VK_TIMEOUT. If the device does not answer, it
/// counts as lost and abandoned (gpu/handle.hpp) from then on, and failure() is thrown.
VkResult wait_patiently(const Device& device, double limit_s, const std::function<VkResult(std::uint64_t)>& wait);

}  // namespace palpa::gpu
