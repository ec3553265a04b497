// Passes values from one thread to another. The newest value wins, and the writer does not wait for a slow reader.
#pragma once

#include <array>
#include <chrono>
#include <condition_variable>
#include <mutex>

#include "session/clock.hpp"

namespace palpa::session {

/// Three values of T rotate through the roles of writer's value, waiting value and reader's value. Each side owns its
/// value while it works on it; only indices are exchanged. T keeps its storage, so large vectors are passed at no cost.
template <typename T>
class Newest {
 public:
  /// All waits are by this clock, which must outlive the object.
  explicit Newest(const Clock& clock = real_clock()) : clock_(clock) {}

  /// To be called before either side begins: applies `prepare` to all three values, e.g. to reserve memory.
  template <typename Prepare>
  void each(Prepare prepare) {
    for (T& value : values_)
      prepare(value);
  }

  /// The writer's value. Only the writing thread touches it.
  T& back() { return values_[back_]; }

  /// Makes the writer's value the waiting one. Returns true if this replaced an unread value.
  bool publish() {
    bool replaced = false;
    {
      const std::lock_guard lock(mutex_);
      std::swap(back_, waiting_);
      replaced = fresh_;
      fresh_ = true;
    }
    clock_.wake(arrived_);
    return replaced;
  }

  /// Marks the end of writing: readers no longer wait for more values.
  void close() {
    {
      const std::lock_guard lock(mutex_);
      closed_ = true;
    }
    clock_.wake(arrived_);
    clock_.wake(taken_);
  }
  bool closed() {
    const std::lock_guard lock(mutex_);
    return closed_ && !fresh_;
  }

  /// Makes the waiting value the reader's if it is new; waits up to `timeout` for one. Returns false if there was none;
  /// front() is then unchanged.
  bool take(std::chrono::duration<double> timeout = {}) {
    std::unique_lock lock(mutex_);
    if (timeout.count() > 0) clock_.wait(arrived_, lock, timeout.count(), [this] { return fresh_ || closed_; });
    if (!fresh_) return false;
    std::swap(front_, waiting_);
    fresh_ = false;
    lock.unlock();
    clock_.wake(taken_);
    return true;
  }
  /// The reader's value. Only the reading thread touches it.
  T& front() { return values_[front_]; }

  /// For writers that must not replace an unread value: waits until the value has been taken or the timeout passes.
  bool wait_taken(std::chrono::duration<double> timeout) {
    std::unique_lock lock(mutex_);
    return clock_.wait(taken_, lock, timeout.count(), [this] { return !fresh_ || closed_; });
  }

 private:
  const Clock& clock_;
  std::array<T, 3> values_{};
  std::size_t back_ = 0, waiting_ = 1, front_ = 2;
  std::mutex mutex_;
  std::condition_variable arrived_, taken_;
  bool fresh_ = false;
  bool closed_ = false;
};

}  // namespace palpa::session
