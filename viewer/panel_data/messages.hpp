// Lines for the user: the log, and those that are shown for a while.
#pragma once

#include <deque>
#include <string>
#include <vector>

#include "base/log.hpp"

namespace palpa::viewer {

/// A line that is shown for a while, whatever else is open.
struct Toast {
  std::string text;
  log::Level level = log::Level::info;
  double until_s = 0;   ///< on the application's clock
  std::string about{};  ///< what it is about; it goes when this is in order again
};

class Messages {
 public:
  /// Shows a line for a while and logs it. `about`: what it is about; see settled().
  void say(log::Level level, const std::string& line, const std::string& about = {});
  /// What was about this is in order again, so its lines go.
  void settled(const std::string& about);
  /// Sets the time, drops lines that were shown long enough, and takes what was logged. Warnings are shown, too.
  void advance(double now_s, const std::vector<log::Line>& logged);

  const std::deque<Toast>& toasts() const { return toasts_; }
  /// The newest lines, the oldest first.
  const std::deque<log::Line>& log() const { return log_; }
  /// Whether toasts have changed since drew(), which is called when a picture shows them.
  bool changed() const { return changed_; }
  void drew() { changed_ = false; }

 private:
  std::deque<Toast> toasts_;
  std::deque<log::Line> log_;
  double now_s_ = 0;
  bool changed_ = false;
};

}  // namespace palpa::viewer
