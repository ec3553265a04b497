#include "gpu/patience.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <string>
#include <system_error>

#include "base/error.hpp"
#include "gpu/handle.hpp"
#include "gpu/software.hpp"

namespace palpa::gpu {
namespace {

constexpr double longest_slice_s = 1;
constexpr double standstill = 1e-3;  // of a slice: threads that wait for work are woken occasionally

/// The clock of another thread of this process, as the kernel numbers such clocks (pthread_getcpuclockid).
clockid_t processor_clock(int thread) {
  return static_cast<clockid_t>((~static_cast<unsigned>(thread) << 3) | 6u);
}

/// Reads the state letter behind the name, which is in brackets: running or waiting to run, or waiting for a disk.
bool may_run(int thread) {
  std::ifstream in(fmt::format("/proc/self/task/{}/stat", thread));
  std::string line;
  std::getline(in, line);
  const std::size_t name_end = line.rfind(')');
  if (name_end == std::string::npos || name_end + 2 >= line.size()) return false;
  const char state = line[name_end + 2];
  return state == 'R' || state == 'D';
}

}  // namespace

std::vector<int> threads_of_process() {
  std::vector<int> threads;
  std::error_code fault;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/task", fault)) {
    const std::string name = entry.path().filename();
    int id = 0;
    if (std::from_chars(name.data(), name.data() + name.size(), id).ec == std::errc()) threads.push_back(id);
  }
  std::sort(threads.begin(), threads.end());
  return threads;
}

std::vector<ThreadWork> work_of(std::span<const int> threads) {
  std::vector<ThreadWork> work;
  for (const int thread : threads) {
    timespec time{};
    if (clock_gettime(processor_clock(thread), &time) != 0) time = {};
    work.push_back({static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec), may_run(thread)});
  }
  return work;
}

double Patience::slice_s() const {
  return std::min(limit_s_ / 4, longest_slice_s);
}

bool Patience::ends(double waited_s, std::span<const ThreadWork> threads) {
  const double counted_s = std::min(waited_s, 2 * slice_s());
  if (!software_) return (waited_s_ += counted_s) >= limit_s_;
  if (first_.empty()) {
    first_.assign(threads.begin(), threads.end());
    last_ = first_;
    return false;
  }
  double busiest_s = 0, gained_s = 0;
  bool any_may_run = false;
  for (std::size_t i = 0; i < std::min(threads.size(), first_.size()); ++i) {
    busiest_s = std::max(busiest_s, threads[i].processor_s - first_[i].processor_s);
    gained_s += std::max(0.0, threads[i].processor_s - last_[i].processor_s);
    any_may_run |= threads[i].may_run;
  }
  last_.assign(threads.begin(), threads.end());
  waited_s_ = any_may_run || gained_s > standstill * counted_s ? 0 : waited_s_ + counted_s;
  return waited_s_ >= limit_s_ || busiest_s >= limit_s_;
}

std::string Patience::reason() const {
  if (!software_) return fmt::format("no answer within {} s; another program may be using the GPU", limit_s_);
  if (waited_s_ >= limit_s_) return fmt::format("no answer within {} s, in which its threads did nothing", limit_s_);
  return fmt::format("no answer within {} s of processor time", limit_s_);
}

VkResult wait_patiently(const Device& device, double limit_s, const std::function<VkResult(std::uint64_t)>& wait) {
  using Clock = std::chrono::steady_clock;
  // If no threads are known to be the driver's, only the wall clock can be used.
  const bool software = is_software(device.description()) && !device.driver_threads().empty();
  Patience patience(limit_s, software);
  for (;;) {
    const auto begin = Clock::now();
    const VkResult result = wait(static_cast<std::uint64_t>(patience.slice_s() * 1e9));
    if (result != VK_TIMEOUT) return result;
    const double waited_s = std::chrono::duration<double>(Clock::now() - begin).count();
    const auto work = software ? work_of(device.driver_threads()) : std::vector<ThreadWork>();
    if (!patience.ends(waited_s, work)) continue;
    device.lose();
    device_abandoned = true;
    throw failure(fmt::format("{}: {}", device.description().name, patience.reason()));
  }
}

}  // namespace palpa::gpu
