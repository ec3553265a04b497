// A thread that starts others.
#pragma once

#include <condition_variable>
#include <functional>
#include <future>
#include <mutex>
#include <thread>

namespace palpa::viewer {

/// Threads give way as much as the one that starts them. Made before give_way(), this one starts those that must not.
class Starter {
 public:
  Starter();
  ~Starter();
  Starter(const Starter&) = delete;
  Starter& operator=(const Starter&) = delete;

  /// Does `job` on this thread and waits for its end. Throws what that throws.
  void run(const std::function<void()>& job);

 private:
  void work();

  std::mutex mutex_;
  std::condition_variable changed_;
  std::packaged_task<void()> job_;
  bool ending_ = false;
  std::thread thread_;
};

}  // namespace palpa::viewer
