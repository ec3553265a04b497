// What long work is doing, for whoever waits for it.
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <string>

namespace palpa {

struct Doing {
  std::string what;                   ///< outermost first: "checks mesh \"x\": looks for crossings"
  std::uint64_t done = 0, total = 0;  ///< of the innermost
};

/// While it lives, this process does `what`. They nest: what is made within another is a part of it. One thread at a
/// time makes them; any thread may advance them and look.
class Activity {
 public:
  /// `what` is a verb with its object: "checks mesh \"bunny\"". Of `total` steps; 0 where nobody counts.
  /// Throws failure() where this thread is Cancellable and was cancelled.
  explicit Activity(std::string what, std::uint64_t total = 0);
  ~Activity();
  Activity(const Activity&) = delete;
  Activity& operator=(const Activity&) = delete;

  void advance(std::uint64_t steps = 1) { done_.fetch_add(steps, std::memory_order_relaxed); }
  /// So many are done.
  void reach(std::uint64_t done) { done_.store(done, std::memory_order_relaxed); }

 private:
  friend std::optional<Doing> doing();

  std::string what_;
  std::uint64_t total_;
  std::atomic<std::uint64_t> done_{0};
};

/// While it lives, what its thread does ends where it begins another Activity, once `stop` is set.
class Cancellable {
 public:
  explicit Cancellable(const std::atomic<bool>& stop);
  ~Cancellable();
  Cancellable(const Cancellable&) = delete;
  Cancellable& operator=(const Cancellable&) = delete;
};

/// What is being done now.
std::optional<Doing> doing();

}  // namespace palpa
