#include "setup/process/interrupt.hpp"

#include <semaphore.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>

#include "base/error.hpp"
#include "base/system/start_thread.hpp"
#include "session/threads.hpp"
#include "setup/process/ending.hpp"

namespace palpa::setup {
namespace {

using namespace std::chrono_literals;

/// Parts of the one second in which palpa must end. The remaining time is for the line, and for the system to end the
/// process.
constexpr auto patience = 750ms, for_the_line = 150ms;

std::atomic<bool> requested_flag{false};
std::atomic<bool> signal_came{false};  ///< set only by a signal
static_assert(std::atomic<bool>::is_always_lock_free);
std::atomic<void (*)()> restore_something{nullptr};

/// Posted by the signal; its type is safe in a signal handler.
sem_t first_signal;

/// Those with which a person or a program asks palpa to end. A run that others end is not complete.
bool asks(int signal) {
  return signal == SIGINT || signal == SIGTERM || signal == SIGHUP || signal == SIGQUIT || signal == SIGTSTP;
}

void note(int signal) {
  if (!signal_came && !asks(signal)) note_cut_short(signal);
  const bool first = !signal_came.exchange(true);  // before the flag: code that clears the flag checks this afterwards
  requested_flag = true;
  if (first) sem_post(&first_signal);
}

/// Handles signals that a write of this process also raises: SIGPIPE if nobody reads, SIGXFSZ if a file may not grow.
/// In these cases, the write's own error is sufficient and the signal is ignored. From another process, the signal asks
/// palpa to end.
void note_from_others(int signal, siginfo_t* from, void*) {
  if (from->si_pid != getpid()) note(signal);
}

/// All signals that end or stop a program that does not catch them, with three exceptions: those that cannot be caught
/// (SIGKILL, SIGSTOP, the C library's own 32 and 33), crashes, after which nothing can end properly, and those that a
/// write also raises.
std::vector<int> ending_signals() {
  std::vector<int> signals{SIGINT,  SIGTERM, SIGHUP,    SIGQUIT, SIGTSTP, SIGUSR1, SIGUSR2,
                           SIGALRM, SIGXCPU, SIGVTALRM, SIGPROF, SIGIO,   SIGPWR,  SIGSTKFLT};
  for (int signal = SIGRTMIN; signal <= SIGRTMAX; ++signal)
    signals.push_back(signal);
  return signals;
}

}  // namespace

/// Ends the program a while after the first signal.
struct Interrupt::Deadline {
  std::string late;
  std::atomic<bool> called_off{false};
  std::mutex mutex;
  std::function<void()> came;

  static void watch(const std::shared_ptr<Deadline>& deadline) {
    session::go_first();  // a busy machine must not keep its line back
    while (sem_wait(&first_signal) != 0 && errno == EINTR) {
    }
    if (deadline->called_off) return;
    // On another thread, because a window server may not answer.
    try {
      std::thread([deadline] {
        const std::lock_guard lock(deadline->mutex);
        if (deadline->came) deadline->came();
      }).detach();
    } catch (const std::exception&) {  // no memory for another thread: the flag is enough
    }
    std::this_thread::sleep_for(patience);
    if (deadline->called_off) return;  // the signal came when everything was already over
    // Written by another thread, because it may have to wait for its reader.
    if (decide_ending(Exit::failed)) {
      try {
        std::thread([line = deadline->late] { tell_ending(line); }).detach();
      } catch (const std::exception&) {  // no memory for another thread: palpa ends without the line
      }
    }
    // If the program's own thread has decided, its line gets this time. Only its clean-up is late then.
    wait_for_line(for_the_line);
    if (void (*const restore)() = restore_something) restore();
    ::_exit(static_cast<int>(ending()));
  }
};

Interrupt::Interrupt(std::string late, std::function<void()> came) : deadline_(std::make_shared<Deadline>()) {
  requested_flag = signal_came = false;
  sem_init(&first_signal, 0, 0);
  deadline_->late = std::move(late);
  deadline_->came = std::move(came);
  watch_ = start_thread("the watch for signals", [deadline = deadline_] { Deadline::watch(deadline); });
  struct sigaction action {};
  action.sa_handler = note;
  sigemptyset(&action.sa_mask);
  action.sa_flags = SA_RESTART;
  for (const int signal : ending_signals())
    replace(signal, action);
  action.sa_sigaction = note_from_others;
  action.sa_flags = SA_RESTART | SA_SIGINFO;
  for (const int signal : {SIGPIPE, SIGXFSZ})
    replace(signal, action);
  action.sa_flags = SA_RESTART;
  // A terminal that stops background programs when they write would leave the last drive sounding.
  action.sa_handler = SIG_IGN;
  for (const int signal : {SIGTTOU, SIGTTIN})
    replace(signal, action);
}

Interrupt::~Interrupt() {
  for (const auto& [signal, before] : before_)
    sigaction(signal, &before, nullptr);
  {
    const std::lock_guard lock(deadline_->mutex);
    deadline_->came = {};
  }
  if (signal_came) {
    watch_.detach();
    return;
  }
  deadline_->called_off = true;
  sem_post(&first_signal);
  watch_.join();
}

bool Interrupt::signalled() {
  return signal_came;
}

void Interrupt::at_the_end(void (*restore)()) {
  restore_something = restore;
}

std::atomic<bool>& Interrupt::flag() {
  return requested_flag;
}

void Interrupt::replace(int signal, const struct sigaction& action) {
  struct sigaction before {};
  if (sigaction(signal, nullptr, &before) != 0 || before.sa_handler == SIG_IGN) return;
  if (sigaction(signal, &action, nullptr) == 0) before_.emplace_back(signal, before);
}

}  // namespace palpa::setup
