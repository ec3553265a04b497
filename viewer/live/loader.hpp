// Loads in the background. A file that is broken or no longer wanted leaves the picture and the run as they are.
#pragma once

#include <atomic>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

namespace palpa::viewer {

class Loader {
 public:
  /// `wake` is called on another thread when something was loaded or failed to load.
  explicit Loader(std::function<void()> wake);
  /// Cancels the job and waits for its end.
  ~Loader();
  Loader(const Loader&) = delete;
  Loader& operator=(const Loader&) = delete;

  /// Runs `job` on a thread that gives way, in place of a job that is under way.
  void begin(std::function<void()> job);
  /// The job's result is no longer wanted. The job ends when it begins its next Activity (base/activity.hpp).
  void cancel();
  bool busy() const;
  /// Why the newest job failed, returned once; empty if it did not fail. nullopt while it is under way.
  std::optional<std::string> take();

 private:
  void work();

  std::function<void()> wake_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::function<void()> next_;
  std::optional<std::string> result_;
  std::atomic<bool> stop_{false};
  bool running_ = false, ending_ = false;
  std::thread thread_;
};

}  // namespace palpa::viewer
