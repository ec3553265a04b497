#include "session/give_way.hpp"

#include <sched.h>
#include <sys/resource.h>

#include <algorithm>
#include <cerrno>
#include <csignal>

namespace palpa::session {

void take_no_signals() {
  sigset_t all;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, nullptr);
}

void give_way() {
  const sched_param none{};
  // Who runs when nobody else wants to is to stay so.
  const bool idle = sched_getscheduler(0) == SCHED_IDLE;
  if (!idle && sched_setscheduler(0, SCHED_BATCH, &none) != 0) sched_setscheduler(0, SCHED_IDLE, &none);
  // Process 0 is the calling thread alone. -1 is a niceness, too.
  errno = 0;
  const int nice = getpriority(PRIO_PROCESS, 0);
  if (errno == 0) setpriority(PRIO_PROCESS, 0, std::min(nice + 10, 19));
}

}  // namespace palpa::session
