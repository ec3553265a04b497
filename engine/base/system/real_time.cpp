#include "base/system/real_time.hpp"

#include <sched.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <ctime>
#include <memory>

namespace palpa {
namespace {

constexpr int favoured_nice = -10;
constexpr rlim_t longest_turn_us = 100'000;
constexpr rlim_t killed_after_us = 200'000;  // a service refuses threads with a longer limit

/// The threads with a turn in real time; 0: none. A signal's handler reads it.
std::array<std::atomic<pid_t>, 8> threads{};
static_assert(std::atomic<pid_t>::is_always_lock_free);

pid_t this_thread() {
  return static_cast<pid_t>(syscall(SYS_gettid));
}

/// Only root may clear the flag that children do not inherit the policy.
void schedule_normally(pid_t thread) {
  const sched_param none{};
  sched_setscheduler(thread, SCHED_OTHER | SCHED_RESET_ON_FORK, &none);
}

/// The kernel says that one of the threads has run for too long, but not which.
void end_turns(int /*signal*/) {
  const int before = errno;
  for (const std::atomic<pid_t>& thread : threads) {
    if (const pid_t number = thread; number != 0) schedule_normally(number);
  }
  errno = before;
}

/// A turn of longest_turn_us ends in end_turns(). The kernel moves this limit when it is reached, so each turn sets it
/// again. If a service is to be asked, a thread that goes on for killed_after_us would be killed.
void limit_turns(bool for_service) {
  struct sigaction now {};
  if (sigaction(SIGXCPU, nullptr, &now) == 0 && now.sa_handler == SIG_DFL) {
    struct sigaction action {};
    sigemptyset(&action.sa_mask);
    action.sa_flags = SA_RESTART;
    action.sa_handler = end_turns;
    sigaction(SIGXCPU, &action, nullptr);
  }
  rlimit limit{};
  if (getrlimit(RLIMIT_RTTIME, &limit) != 0) return;
  if (for_service && limit.rlim_max > killed_after_us) limit.rlim_max = killed_after_us;
  limit.rlim_cur = std::min(longest_turn_us, limit.rlim_max);
  setrlimit(RLIMIT_RTTIME, &limit);
}

void let_through(int signal) {
  sigset_t one;
  sigemptyset(&one);
  sigaddset(&one, signal);
  pthread_sigmask(SIG_UNBLOCK, &one, nullptr);
}

constexpr const char* autogroup_file = "/proc/self/autogroup";

/// Reads "/autogroup-123 nice 0". False: this kernel has none.
bool read_autogroup(int& niceness) {
  const std::unique_ptr<FILE, int (*)(FILE*)> file(std::fopen(autogroup_file, "re"), std::fclose);
  return file && std::fscanf(file.get(), "/autogroup-%*d nice %d", &niceness) == 1;
}

bool write_autogroup(int niceness) {
  FILE* const file = std::fopen(autogroup_file, "we");
  if (!file) return false;
  const bool written = std::fprintf(file, "%d", niceness) > 0;
  return (std::fclose(file) == 0) && written;
}

}  // namespace

std::string_view to_text(Scheduling scheduling) {
  switch (scheduling) {
    case Scheduling::normal:
      return "normal";
    case Scheduling::favoured:
      return "favoured";
    case Scheduling::real_time:
      return "real-time";
    case Scheduling::unknown:
      break;
  }
  return "unknown";
}

bool keep_in_memory() {
  return mlockall(MCL_CURRENT | MCL_ONFAULT) == 0;
}

Scheduling scheduling_of(pid_t thread) {
  const int policy = sched_getscheduler(thread);
  if (policy < 0) return Scheduling::unknown;
  const int plain = policy & ~SCHED_RESET_ON_FORK;
  if (plain == SCHED_FIFO || plain == SCHED_RR) return Scheduling::real_time;
  errno = 0;
  const int niceness = getpriority(PRIO_PROCESS, static_cast<id_t>(thread));
  return errno == 0 && niceness <= favoured_nice ? Scheduling::favoured : Scheduling::normal;
}

RealTime::RealTime(int priority, const RealTimeService& service) : thread_(this_thread()) {
  bool listed = false;
  for (std::atomic<pid_t>& place : threads) {
    pid_t none = 0;
    if ((listed = place.compare_exchange_strong(none, thread_))) break;
  }
  if (!listed) return;
  limit_turns(false);
  let_through(SIGXCPU);
  const sched_param wish{.sched_priority = priority};
  if (sched_setscheduler(thread_, SCHED_RR | SCHED_RESET_ON_FORK, &wish) != 0 && service) {
    limit_turns(true);
    service(getpid(), thread_, priority);
  }
  if (scheduling_of(thread_) != Scheduling::real_time) {
    favour();
    return;
  }
  // The kernel counts from a thread's last sleep in real time, and still has the count of an earlier turn.
  const timespec asleep{0, 200'000};  // for less, a thread may not sleep at all
  nanosleep(&asleep, nullptr);
}

void RealTime::favour() {
  errno = 0;
  before_ = getpriority(PRIO_PROCESS, static_cast<id_t>(thread_));
  favoured_ = errno == 0 && before_ > favoured_nice &&
              setpriority(PRIO_PROCESS, static_cast<id_t>(thread_), favoured_nice) == 0;
  session_favoured_ =
      read_autogroup(session_before_) && session_before_ > favoured_nice && write_autogroup(favoured_nice);
}

RealTime::~RealTime() {
  if (scheduling_of(thread_) == Scheduling::real_time) schedule_normally(thread_);
  if (favoured_) setpriority(PRIO_PROCESS, static_cast<id_t>(thread_), before_);
  if (session_favoured_) write_autogroup(session_before_);
  for (std::atomic<pid_t>& place : threads) {
    pid_t mine = thread_;
    if (place.compare_exchange_strong(mine, 0)) break;
  }
}

}  // namespace palpa
