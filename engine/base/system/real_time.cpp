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
#include <mutex>

namespace palpa {
namespace {

constexpr int favoured_nice = -10;
constexpr rlim_t longest_turn_us = 100'000;
constexpr rlim_t killed_after_us = 200'000;  // a service refuses threads with a longer limit
constexpr rlim_t least_limit_us = 50'000;

/// The threads with a turn in real time; 0: none. A signal's handler reads it.
std::array<std::atomic<pid_t>, 8> threads{};
static_assert(std::atomic<pid_t>::is_always_lock_free);

/// The handlers of SIGXCPU from before; null: none.
std::atomic<void (*)(int)> plain_handler{};
std::atomic<void (*)(int, siginfo_t*, void*)> handler_with_facts{};

/// What is the whole process's, and how it was before the first object changed it.
struct Process {
  std::mutex mutex;
  bool limit_may_be_lowered = false, knows_forks = false;
  int turns = 0, kept = 0;  ///< objects that exist
  rlimit limit{};
  struct sigaction action {};
};

Process& whole_process() {
  static Process one;
  return one;
}

pid_t this_thread() {
  return static_cast<pid_t>(syscall(SYS_gettid));
}

/// Only root may clear the flag that children do not inherit the policy.
void schedule_normally(pid_t thread) {
  const sched_param none{};
  sched_setscheduler(thread, SCHED_OTHER | SCHED_RESET_ON_FORK, &none);
}

/// Whether the process has used about as much of the processor as it may: then, SIGXCPU says that, too.
bool has_used_its_processor_time() {
  rlimit limit{};
  timespec used{};
  return getrlimit(RLIMIT_CPU, &limit) == 0 && clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &used) == 0 &&
         static_cast<rlim_t>(used.tv_sec) + 3 > limit.rlim_cur;  // the kernel has added a second, and counts by ticks
}

/// The kernel says that one of the threads has run for too long, but not which.
void end_turns(int signal, siginfo_t* facts, void* context) {
  const int before = errno;
  for (const std::atomic<pid_t>& thread : threads) {
    if (const pid_t number = thread; number != 0) schedule_normally(number);
  }
  const bool from_a_program = facts->si_code <= 0;
  if (from_a_program || has_used_its_processor_time()) {
    if (auto* const handler = handler_with_facts.load()) handler(signal, facts, context);
    if (auto* const handler = plain_handler.load()) handler(signal);
  }
  errno = before;
}

/// The mutex is held.
void begin_turns(Process& all) {
  if (all.turns++ > 0) return;
  getrlimit(RLIMIT_RTTIME, &all.limit);
  sigaction(SIGXCPU, nullptr, &all.action);
  const bool with_facts = (all.action.sa_flags & SA_SIGINFO) != 0;
  const bool plain = !with_facts && all.action.sa_handler != SIG_DFL && all.action.sa_handler != SIG_IGN;
  handler_with_facts = with_facts ? all.action.sa_sigaction : nullptr;
  plain_handler = plain ? all.action.sa_handler : nullptr;
  struct sigaction action {};
  sigemptyset(&action.sa_mask);
  action.sa_flags = SA_RESTART | SA_SIGINFO | (all.action.sa_flags & SA_ONSTACK);
  action.sa_sigaction = end_turns;
  sigaction(SIGXCPU, &action, nullptr);
}

/// The mutex is held, and no thread has a turn any more.
void restore(const Process& all) {
  rlimit limit = all.limit;
  if (setrlimit(RLIMIT_RTTIME, &limit) != 0 && getrlimit(RLIMIT_RTTIME, &limit) == 0) {
    limit.rlim_cur = std::min(all.limit.rlim_cur, limit.rlim_max);
    setrlimit(RLIMIT_RTTIME, &limit);
  }
  struct sigaction now {};
  sigaction(SIGXCPU, nullptr, &now);
  if ((now.sa_flags & SA_SIGINFO) == 0 || now.sa_sigaction != end_turns) return;
  // A signal that still waits is dropped: the earlier action would end the process.
  now = {};
  now.sa_handler = SIG_IGN;
  sigaction(SIGXCPU, &now, nullptr);
  sigaction(SIGXCPU, &all.action, nullptr);
}

/// A process that fork() makes has neither these threads nor the locks on its memory.
void forget_turns_of_parent() {
  Process& all = whole_process();
  for (std::atomic<pid_t>& thread : threads)
    thread = 0;
  if (all.turns > 0) restore(all);
  all.turns = all.kept = 0;
  all.mutex.unlock();
}

/// Locked. The first call makes sure that a process which fork() makes begins without turns.
std::unique_lock<std::mutex> locked(Process& all) {
  std::unique_lock<std::mutex> lock(all.mutex);
  if (!all.knows_forks) {
    pthread_atfork([] { whole_process().mutex.lock(); }, [] { whole_process().mutex.unlock(); },
                   forget_turns_of_parent);
    all.knows_forks = true;
  }
  return lock;
}

/// A turn that is too long ends in end_turns(), well before the kernel kills. The kernel moves this limit when it is
/// reached, so each turn sets it again. For a service, the limit is lowered. Returns false if that is not allowed.
bool limit_turns(bool for_service) {
  rlimit limit{};
  if (getrlimit(RLIMIT_RTTIME, &limit) != 0) return false;
  if (for_service && limit.rlim_max > killed_after_us) {
    Process& all = whole_process();
    const auto lock = locked(all);
    if (!all.limit_may_be_lowered) return false;
    limit.rlim_max = killed_after_us;
  }
  limit.rlim_cur = std::min(longest_turn_us, limit.rlim_max / 2);
  return setrlimit(RLIMIT_RTTIME, &limit) == 0;
}

/// Returns whether the calling thread blocked it before.
bool let_through(int signal) {
  sigset_t one, before;
  sigemptyset(&one);
  sigaddset(&one, signal);
  pthread_sigmask(SIG_UNBLOCK, &one, &before);
  return sigismember(&before, signal) == 1;
}

/// Whether the process has locked memory.
bool has_locked_memory() {
  const std::unique_ptr<FILE, int (*)(FILE*)> file(std::fopen("/proc/self/status", "re"), std::fclose);
  std::array<char, 256> line{};
  unsigned long kib = 0;
  while (file && std::fgets(line.data(), line.size(), file.get())) {
    if (std::sscanf(line.data(), "VmLck: %lu", &kib) == 1) break;
  }
  return kib > 0;
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

KeptInMemory::KeptInMemory(Pages pages) {
  Process& all = whole_process();
  const auto lock = locked(all);
  if (all.kept == 0 && has_locked_memory()) return;
  holds_ = mlockall(pages == Pages::all ? MCL_CURRENT : MCL_CURRENT | MCL_ONFAULT) == 0;
  all.kept += holds_ ? 1 : 0;
}

KeptInMemory::~KeptInMemory() {
  if (!holds_) return;
  Process& all = whole_process();
  const auto lock = locked(all);
  if (all.kept > 0 && --all.kept == 0) munlockall();
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

void allow_lower_limit() {
  Process& all = whole_process();
  const auto lock = locked(all);
  all.limit_may_be_lowered = true;
}

bool has_time_for_real_time(pid_t process) {
  rlimit limit{};
  return prlimit(process, RLIMIT_RTTIME, nullptr, &limit) == 0 && limit.rlim_max >= least_limit_us;
}

RealTime::RealTime(int priority, const RealTimeService& service) : thread_(this_thread()) {
  {
    Process& all = whole_process();
    const auto lock = locked(all);
    for (std::atomic<pid_t>& place : threads) {
      pid_t none = 0;
      if ((listed_ = place.compare_exchange_strong(none, thread_))) break;
    }
    if (!listed_) return;
    begin_turns(all);
  }
  signal_was_blocked_ = let_through(SIGXCPU);
  if (has_time_for_real_time(0)) ask(priority, service);
  if (scheduling_of(thread_) != Scheduling::real_time) {
    favour();
    return;
  }
  // The kernel counts from a thread's last sleep in real time, and still has the count of an earlier turn.
  const timespec asleep{0, 200'000};  // for less, a thread may not sleep at all
  nanosleep(&asleep, nullptr);
}

void RealTime::ask(int priority, const RealTimeService& service) {
  if (!limit_turns(false)) return;
  const sched_param wish{.sched_priority = priority};
  if (sched_setscheduler(thread_, SCHED_RR | SCHED_RESET_ON_FORK, &wish) == 0) return;
  if (service && limit_turns(true)) service(getpid(), thread_, priority);
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
  if (!listed_) return;
  Process& all = whole_process();
  const auto lock = locked(all);
  for (std::atomic<pid_t>& place : threads) {
    pid_t mine = thread_;
    if (place.compare_exchange_strong(mine, 0)) break;
  }
  if (all.turns > 0 && --all.turns == 0) restore(all);
  if (!signal_was_blocked_) return;
  sigset_t one;
  sigemptyset(&one);
  sigaddset(&one, SIGXCPU);
  pthread_sigmask(SIG_BLOCK, &one, nullptr);
}

}  // namespace palpa
