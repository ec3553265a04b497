// What a long computation is currently doing, for progress reports.
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <string>

namespace palpa {

struct Doing {
  std::string what;                   ///< outermost activity first: "checks mesh \"x\": looks for crossings"
  std::uint64_t done = 0, total = 0;  ///< steps of the innermost activity
};

/// An activity of this process, from construction to destruction. Activities nest: one that begins inside another is a
/// part of it. Only one thread at a time may construct them; any thread may advance and read them.
class Activity {
 public:
  /// `what` is a verb with its object: "checks mesh \"bunny\"". `total` is the number of steps; 0 if the steps are not
  /// counted. Throws failure() if this thread is Cancellable and was cancelled.
  explicit Activity(std::string what, std::uint64_t total = 0);
  ~Activity();
  Activity(const Activity&) = delete;
  Activity& operator=(const Activity&) = delete;

  /// Throws failure() if this thread is Cancellable and was cancelled.
  void advance(std::uint64_t steps = 1);
  /// Sets the number of finished steps.
  void reach(std::uint64_t done) { done_.store(done, std::memory_order_relaxed); }

 private:
  friend std::optional<Doing> doing();

  std::string what_;
  std::uint64_t total_;
  std::atomic<std::uint64_t> done_{0};
};

/// During its lifetime, work on its thread ends soon after `stop` is set: when an Activity begins or advances, or
/// between the chunks of parallel_chunks().
class Cancellable {
 public:
  explicit Cancellable(const std::atomic<bool>& stop);
  ~Cancellable();
  Cancellable(const Cancellable&) = delete;
  Cancellable& operator=(const Cancellable&) = delete;
};

/// The flag of this thread's Cancellable; null if there is none.
const std::atomic<bool>* cancel_flag();
/// Throws failure() if the flag of cancel_flag() is set.
void stop_if_cancelled(const std::atomic<bool>* flag);

/// The current activity of the process, if any.
std::optional<Doing> doing();

}  // namespace palpa
