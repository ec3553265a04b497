#include "viewer/live/starter.hpp"

#include <utility>

#include "base/system/start_thread.hpp"

namespace palpa::viewer {

Starter::Starter() : thread_(start_thread("a live run", [this] { work(); })) {}

Starter::~Starter() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  changed_.notify_one();
  thread_.join();
}

void Starter::run(const std::function<void()>& job) {
  std::packaged_task<void()> task(job);
  std::future<void> done = task.get_future();
  {
    const std::lock_guard lock(mutex_);
    job_ = std::move(task);
  }
  changed_.notify_one();
  done.get();
}

void Starter::work() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return ending_ || job_.valid(); });
    if (ending_) return;
    std::packaged_task<void()> job = std::exchange(job_, {});
    lock.unlock();
    job();
    lock.lock();
  }
}

}  // namespace palpa::viewer
