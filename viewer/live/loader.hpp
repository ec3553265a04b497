// Loads beside what is shown, so that a file that is broken, or that nobody wants any more, ends nothing.
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
  /// `wake` is called on another thread when something is loaded, or failed to be.
  explicit Loader(std::function<void()> wake);
  /// Cancels, and waits for that.
  ~Loader();
  Loader(const Loader&) = delete;
  Loader& operator=(const Loader&) = delete;

  /// Does `job` on a thread that gives way, in place of one that is under way.
  void begin(std::function<void()> job);
  /// Its end is nobody's business any more; it ends where it begins something else (base/activity.hpp).
  void cancel();
  bool busy() const;
  /// Of the newest job, once: why it failed, empty where it did not. Nothing while it is under way.
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
