// Hands values from one thread to another; the newest wins and no one waits for a slow reader.
#pragma once

#include <array>
#include <chrono>
#include <condition_variable>
#include <mutex>

namespace palpa::session {

/// Three values of T take turns as the writer's, the waiting and the reader's: each side owns its value while it works
/// on it, and only indices change hands. T keeps its storage, so passing large vectors on costs nothing.
template <typename T>
class Newest {
 public:
  /// Before either side begins: does `prepare` to all three values, e.g. gives them room.
  template <typename Prepare>
  void each(Prepare prepare) {
    for (T& value : values_)
      prepare(value);
  }

  /// The writer's value. Only the writing thread touches it.
  T& back() { return values_[back_]; }

  /// Makes the writer's value the waiting one. Returns true if that replaced one that nobody had read.
  bool publish() {
    bool replaced = false;
    {
      const std::lock_guard lock(mutex_);
      std::swap(back_, waiting_);
      replaced = fresh_;
      fresh_ = true;
    }
    arrived_.notify_one();
    return replaced;
  }

  /// The writer's last word: readers no longer wait for more.
  void close() {
    {
      const std::lock_guard lock(mutex_);
      closed_ = true;
    }
    arrived_.notify_all();
    taken_.notify_all();
  }
  bool closed() {
    const std::lock_guard lock(mutex_);
    return closed_ && !fresh_;
  }

  /// Makes the waiting value the reader's if it is new; waits up to `timeout` for one. False: front() is unchanged.
  bool take(std::chrono::duration<double> timeout = {}) {
    std::unique_lock lock(mutex_);
    if (timeout.count() > 0) arrived_.wait_for(lock, timeout, [this] { return fresh_ || closed_; });
    if (!fresh_) return false;
    std::swap(front_, waiting_);
    fresh_ = false;
    lock.unlock();
    taken_.notify_one();
    return true;
  }
  /// The reader's value. Only the reading thread touches it.
  T& front() { return values_[front_]; }

  /// For writers that must not replace an unread value: waits until it has been taken or the timeout passes.
  bool wait_taken(std::chrono::duration<double> timeout) {
    std::unique_lock lock(mutex_);
    return taken_.wait_for(lock, timeout, [this] { return !fresh_ || closed_; });
  }

 private:
  std::array<T, 3> values_{};
  std::size_t back_ = 0, waiting_ = 1, front_ = 2;
  std::mutex mutex_;
  std::condition_variable arrived_, taken_;
  bool fresh_ = false;
  bool closed_ = false;
};

}  // namespace palpa::session
