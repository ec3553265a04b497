// The loop's clock: seconds since its start, and all that its threads wait for. It never goes backwards.
//
// Code that waits takes a Clock, so that its tests need no real time: they pass a clock that stands still while any
// thread works (tests/session/stepped_clock.hpp).
#pragma once

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>
#include <utility>

#include "base/system/start_thread.hpp"

namespace palpa::session {

class Clock {
 public:
  virtual ~Clock() = default;
  /// False: a test's time. Nobody needs to hurry.
  virtual bool is_real() const { return true; }
  virtual double now() const {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
  }
  virtual void sleep_until(double time_s) const {
    std::this_thread::sleep_until(begin_ + std::chrono::duration_cast<std::chrono::steady_clock::duration>(
                                               std::chrono::duration<double>(time_s)));
  }
  /// Waits, for at most `most_s`, until `ready()`, which is called under `lock`; returns its last result. Who changes
  /// what `ready` looks at calls wake() afterwards.
  virtual bool wait(std::condition_variable& changed, std::unique_lock<std::mutex>& lock, double most_s,
                    const std::function<bool()>& ready) const {
    return changed.wait_for(lock, std::chrono::duration<double>(most_s), ready);
  }
  virtual void wake(std::condition_variable& changed) const { changed.notify_all(); }
  /// A thread that waits by this clock. Throws no_thread().
  virtual std::thread start(const char* purpose, std::function<void()> work) const {
    return start_thread(purpose, std::move(work));
  }
  /// Waits for the end of such a thread.
  virtual void join(std::thread& thread) const { thread.join(); }

 private:
  std::chrono::steady_clock::time_point begin_ = std::chrono::steady_clock::now();
};

/// The clock of code that nobody gave another one.
inline const Clock& real_clock() {
  static const Clock clock;
  return clock;
}

}  // namespace palpa::session
