// Progress on a terminal, as a bar or as a line that says what is being done. Where stderr is no terminal nothing is
// written, so that logs stay clean, and nothing by a program in the background, whose terminal belongs to another.
#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <string>
#include <thread>

namespace palpa::setup {

class Progress {
 public:
  /// `total` steps of `what`; 0 shows a count without a bar. Draws nothing if `quiet`.
  Progress(std::string what, std::uint64_t total, bool quiet);
  /// Wipes the bar, so that what is printed next begins on a clean line.
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

/// Shows what long preparation is doing (base/activity.hpp) as long as it lives: on a terminal, in the foreground, as
/// a line that changes; else with --log-level info as a line for each thing that takes more than a moment. Without
/// either it costs nothing.
class Preparing {
 public:
  explicit Preparing(bool quiet);
  /// Wipes the line.
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
