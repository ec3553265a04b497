// Progress on a terminal, as a bar or as a line that names the current step. If stderr is not a terminal, nothing is
// written, so that logs stay clean. A program in the background writes nothing either, because its terminal belongs to
// another program.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <string>
#include <thread>

namespace palpa::setup {

/// Whether stderr is a terminal that this program may write to. The terminal of a background program belongs to
/// another program.
bool is_in_foreground();

class Progress {
 public:
  /// `total` steps of `what`; 0 shows a count without a bar. Draws nothing if `quiet`.
  Progress(std::string what, std::uint64_t total, bool quiet);
  /// Erases the bar, so that the next output begins on a clean line.
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Cheap: redraws at most ten times a second.
  void set(std::uint64_t done);

 private:
  void draw(std::uint64_t done);

  std::string what_;
  std::uint64_t total_;
  bool on_;
  bool drawn_ = false;
  std::chrono::steady_clock::time_point next_{};
};

/// While this object lives, shows the activity of long preparations (base/activity.hpp). On a terminal, in the
/// foreground, it is a line that changes. Otherwise, with --log-level info, it is one line for each activity that takes
/// more than a moment. In all other cases, it costs nothing.
class Preparing {
 public:
  explicit Preparing(bool quiet);
  /// Erases the line.
  ~Preparing();
  Preparing(const Preparing&) = delete;
  Preparing& operator=(const Preparing&) = delete;

 private:
  void watch();

  bool terminal_;
  std::mutex mutex_;
  std::condition_variable end_;
  bool ending_ = false;
  std::thread thread_;
};

}  // namespace palpa::setup
