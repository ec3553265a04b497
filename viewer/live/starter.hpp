// A thread that starts others.
#pragma once

#include <condition_variable>
#include <functional>
#include <future>
#include <mutex>
#include <thread>

namespace palpa::viewer {

/// A new thread gives way as much as the thread that starts it. A Starter that is made before give_way() starts the
/// threads that must not give way.
class Starter {
 public:
  Starter();
  ~Starter();
  Starter(const Starter&) = delete;
  Starter& operator=(const Starter&) = delete;

  /// Runs `job` on this thread and waits for its end. Throws what `job` throws.
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
