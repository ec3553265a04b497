#include "viewer/live/loader.hpp"

#include <exception>
#include <utility>

#include "base/activity.hpp"
#include "base/system/start_thread.hpp"
#include "session/threads.hpp"
#include "viewer/live/live_session.hpp"

namespace palpa::viewer {

Loader::Loader(std::function<void()> wake)
    : wake_(std::move(wake)), thread_(start_thread("reading scenes", [this] { work(); })) {}

Loader::~Loader() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = stop_ = true;
    next_ = {};
  }
  changed_.notify_one();
  thread_.join();
}

void Loader::begin(std::function<void()> job) {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
    next_ = std::move(job);
    result_.reset();
  }
  changed_.notify_one();
}

void Loader::cancel() {
  const std::lock_guard lock(mutex_);
  stop_ = true;
  next_ = {};
  result_.reset();
}

bool Loader::busy() const {
  const std::lock_guard lock(mutex_);
  return next_ || (running_ && !stop_);
}

std::optional<std::string> Loader::take() {
  const std::lock_guard lock(mutex_);
  return std::exchange(result_, std::nullopt);
}

void Loader::work() {
  session::give_way();
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return ending_ || next_; });
    if (ending_) return;
    std::function<void()> job = std::exchange(next_, {});
    stop_ = false;
    running_ = true;
    lock.unlock();
    std::string fault;
    try {
      const Cancellable cancellable(stop_);
      job();
    } catch (const std::exception& error) {
      fault = error.what();
    }
    job = {};
    lock.lock();
    running_ = false;
    if (stop_) continue;
    result_ = std::move(fault);
    lock.unlock();
    if (wake_) wake_();
    lock.lock();
  }
}

}  // namespace palpa::viewer
