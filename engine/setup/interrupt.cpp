#include "setup/interrupt.hpp"

#include <semaphore.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <exception>
#include <mutex>
#include <thread>
#include <utility>

#include "base/error.hpp"
#include "base/log.hpp"
#include "base/start_thread.hpp"

namespace palpa::setup {
namespace {

using namespace std::chrono_literals;

/// Of the second that palpa may take: what is left is for the line, and for the system to take the process down.
constexpr auto patience = 750ms, for_the_line = 50ms;

std::atomic<bool> requested_flag{false};
std::atomic<bool> signal_came{false};  ///< set by a signal, not by others
static_assert(std::atomic<bool>::is_always_lock_free);
std::atomic<void (*)()> restore_something{nullptr};

/// Posted by the signal; of a type that a handler may touch.
sem_t first_signal;

void note(int) {
  const bool first = !signal_came.exchange(true);  // before the flag: whoever clears that asks for this afterwards
  requested_flag = true;
  if (first) sem_post(&first_signal);
}

/// A signal that a write of this process also raises: SIGPIPE where nobody reads, SIGXFSZ where a file may not grow.
/// Then the write's own error counts, and the signal says nothing new. From anybody else it asks palpa to end.
void note_from_others(int signal, siginfo_t* from, void*) {
  if (from->si_pid != getpid()) note(signal);
}

/// All that end or stop a program that does not catch them, but for those that nobody can catch (SIGKILL, SIGSTOP, the
/// C library's own 32 and 33), for crashes, after which there is nothing left that could end well, and for those that
/// a write raises, too.
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
    while (sem_wait(&first_signal) != 0 && errno == EINTR) {
    }
    if (deadline->called_off) return;
    // By another thread: a window's server may not answer.
    try {
      std::thread([deadline] {
        const std::lock_guard lock(deadline->mutex);
        if (deadline->came) deadline->came();
      }).detach();
    } catch (const std::exception&) {  // no room for another thread: the flag will be seen without it
    }
    std::this_thread::sleep_for(patience);
    if (deadline->called_off) return;  // the signal came while all was over
    // Said by another thread, which may have to wait for whoever reads it.
    try {
      std::thread([line = deadline->late] { log::error(line); }).detach();
    } catch (const std::exception&) {  // no room for another thread: it ends without the line
    }
    std::this_thread::sleep_for(for_the_line);
    if (void (*const restore)() = restore_something) restore();
    ::_exit(static_cast<int>(Exit::failed));
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
  // A terminal that stops programs in the background when they write would leave the last drive sounding.
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
