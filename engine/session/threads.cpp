#include "session/threads.hpp"

#include <sched.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <system_error>

namespace palpa::session {
namespace {

/// The kernel's sched_attr. Its header cannot be included together with <sched.h>.
struct Wish {
  std::uint32_t size = sizeof(Wish), policy = 0;
  std::uint64_t flags = 0;
  std::int32_t nice = 0;
  std::uint32_t priority = 0;
  std::uint64_t slice_ns = 0, deadline_ns = 0, period_ns = 0;
};

/// For a thread without a real-time policy. 0: slices of normal length. Kernels before 6.12 ignore it.
void ask_for_slices(int thread, int policy, int nice, std::uint64_t slice_ns) {
  const Wish wish{.policy = static_cast<std::uint32_t>(policy), .nice = nice, .slice_ns = slice_ns};
  syscall(SYS_sched_setattr, thread, &wish, 0U);
}

void ask_for_slices(std::uint64_t slice_ns) {
  if (sched_getscheduler(0) != SCHED_OTHER) return;
  errno = 0;
  const int nice = getpriority(PRIO_PROCESS, 0);
  if (errno == 0) ask_for_slices(0, SCHED_OTHER, nice, slice_ns);
}

constexpr std::uint64_t short_ns = 500'000;  // with shorter ones, a loop's threads interrupt each other
/// Only a little longer than the usual 1 to 3 ms, because a thread that requests long slices waits long for them on a
/// busy machine.
constexpr std::uint64_t long_ns = 10'000'000;

}  // namespace

void take_no_signals() {
  sigset_t all;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, nullptr);
}

void go_first() {
  ask_for_slices(short_ns);
}

void take_turns() {
  ask_for_slices(0);
}

void give_way() {
  give_way(0);
}

void give_way(int thread) {
  const sched_param none{};
  // A thread that runs only on an idle machine must stay so.
  const bool idle = sched_getscheduler(thread) == SCHED_IDLE;
  if (!idle && sched_setscheduler(thread, SCHED_BATCH, &none) != 0) sched_setscheduler(thread, SCHED_IDLE, &none);
  // A "process" is a single thread here, and 0 is the calling one. -1 is also a valid nice value.
  const auto id = static_cast<id_t>(thread);
  errno = 0;
  const int nice = getpriority(PRIO_PROCESS, id);
  if (errno != 0) return;
  const int nicer = std::min(nice + 10, 19);
  setpriority(PRIO_PROCESS, id, nicer);
  if (sched_getscheduler(thread) == SCHED_BATCH) ask_for_slices(thread, SCHED_BATCH, nicer, long_ns);
}

std::vector<int> threads_since(const std::vector<int>& before) {
  std::vector<int> threads;
  std::error_code ignored;
  for (std::filesystem::directory_iterator task("/proc/self/task", ignored), end; !ignored && task != end;
       task.increment(ignored)) {
    const int thread = std::atoi(task->path().filename().c_str());
    if (!std::ranges::binary_search(before, thread)) threads.push_back(thread);
  }
  std::ranges::sort(threads);
  return threads;
}

}  // namespace palpa::session
