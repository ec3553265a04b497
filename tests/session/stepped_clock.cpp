#include "stepped_clock.hpp"

#include <algorithm>
#include <utility>

namespace palpa::test {

double SteppedClock::now() const {
  const std::lock_guard mine(mutex_);
  return now_s_;
}

void SteppedClock::sleep_until(double time_s) const {
  std::unique_lock mine(mutex_);
  if (time_s > now_s_) pause(mine, time_s, nullptr);
}

bool SteppedClock::wait(std::condition_variable& changed, std::unique_lock<std::mutex>& lock, double most_s,
                        const std::function<bool()>& ready) const {
  // Locks are taken in this order: the caller's, then this clock's. The clock's is held from the look at `ready` to the
  // wait, so that no wake() is missed.
  std::unique_lock mine(mutex_);
  const double until_s = now_s_ + most_s;
  while (!ready() && now_s_ < until_s) {
    lock.unlock();
    pause(mine, until_s, &changed);
    mine.unlock();
    lock.lock();
    mine.lock();
  }
  return ready();
}

void SteppedClock::wake(std::condition_variable& changed) const {
  const std::lock_guard mine(mutex_);
  end_waits([&](const Waiting& one) { return one.changed == &changed; });
}

std::thread SteppedClock::start(const char* purpose, std::function<void()> work) const {
  {
    const std::lock_guard mine(mutex_);
    ++threads_;
  }
  return start_thread(purpose, [this, work = std::move(work)] {
    work();
    const std::lock_guard mine(mutex_);
    if (awaited_.erase(std::this_thread::get_id()) > 0) return;  // the thread that waits for this one takes its place
    over_.insert(std::this_thread::get_id());
    --threads_;
    step();
  });
}

void SteppedClock::join(std::thread& thread) const {
  {
    const std::lock_guard mine(mutex_);
    if (over_.erase(thread.get_id()) == 0) {
      awaited_.insert(thread.get_id());
      --threads_;
      step();
    }
  }
  thread.join();
}

void SteppedClock::pause(std::unique_lock<std::mutex>& mine, double until_s,
                         const std::condition_variable* changed) const {
  Waiting self{until_s, changed};
  waiting_.push_back(&self);
  step();
  self.woken.wait(mine, [&] { return self.over; });
}

void SteppedClock::step() const {
  if (waiting_.empty() || waiting_.size() < threads_) return;
  const auto next = std::ranges::min_element(waiting_, {}, [](const Waiting* one) { return one->until_s; });
  now_s_ = std::max(now_s_, (*next)->until_s);
  end_waits([&](const Waiting& one) { return one.until_s <= now_s_; });
}

template <typename Ends>
void SteppedClock::end_waits(Ends ends) const {
  std::erase_if(waiting_, [&](Waiting* one) {
    if (!ends(*one)) return false;
    one->over = true;
    one->woken.notify_all();
    return true;
  });
}

}  // namespace palpa::test
