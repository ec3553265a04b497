// A progress bar on a terminal. Where stderr is no terminal nothing is written, so that logs stay clean, and
// nothing by a program in the background, whose terminal belongs to another.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

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

}  // namespace palpa::setup
