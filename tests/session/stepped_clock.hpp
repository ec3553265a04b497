// A clock without real time: it stands still while any of its threads works, and steps to the next time that one of
// them waits for when all wait. What a test promises about times therefore does not depend on the machine's speed.
#pragma once

#include <condition_variable>
#include <mutex>
#include <set>
#include <thread>
#include <vector>

#include "session/clock.hpp"

namespace palpa::test {

/// Its threads are the one that made it, and those that it started. They must wait only by this clock.
class SteppedClock : public session::Clock {
 public:
  bool is_real() const override { return false; }
  double now() const override;
  void sleep_until(double time_s) const override;
  bool wait(std::condition_variable& changed, std::unique_lock<std::mutex>& lock, double most_s,
            const std::function<bool()>& ready) const override;
  void wake(std::condition_variable& changed) const override;
  std::thread start(const char* purpose, std::function<void()> work) const override;
  void join(std::thread& thread) const override;

  void sleep(double seconds) const { sleep_until(now() + seconds); }

 private:
  struct Waiting {
    double until_s;
    const std::condition_variable* changed;  ///< or null
    bool over = false;
    std::condition_variable woken{};
  };

  void pause(std::unique_lock<std::mutex>& mine, double until_s, const std::condition_variable* changed) const;
  void step() const;
  /// Ends the waits that `ends` tells.
  template <typename Ends>
  void end_waits(Ends ends) const;

  mutable std::mutex mutex_;
  mutable double now_s_ = 0;
  mutable std::size_t threads_ = 1;  ///< that are neither over nor waiting for another's end
  mutable std::vector<Waiting*> waiting_;
  mutable std::set<std::thread::id> awaited_;  ///< others wait for their end
  mutable std::set<std::thread::id> over_;     ///< and nobody has waited for their end yet
};

}  // namespace palpa::test
