// When a run's frames come and how long each takes, so that other work on the same processor runs between them. When a
// frame comes while the processor draws a picture, the kernel does not take the processor away at once, but lets the
// drawing have it for milliseconds.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

#include "session/clock.hpp"

namespace palpa::viewer {

/// All times are in seconds on one clock.
class Rhythm {
 public:
  void arrived(std::uint64_t sequence, double now_s);
  /// The frame has been planned. No frame that came before it is under way any more either.
  void planned(std::uint64_t sequence, double now_s);
  /// nullopt if now is the time to work for `work_s`. Otherwise, the time at which to ask again if no frame has come or
  /// been planned by then. If frames leave less time than `work_s` between them, work begins when a frame is planned.
  /// If another frame has always come by then, no time is right. A frame that does not come, or is not planned for a
  /// long time, is not waited for.
  std::optional<double> wait_until(double now_s, double work_s) const;

 private:
  std::uint64_t newest_ = 0;
  bool under_way_ = false;
  double begun_s_ = 0;
  std::optional<double> last_s_;
  double due_s_ = 0;                  ///< when the next frame comes, if every_s_ is known
  double every_s_ = 0, takes_s_ = 0;  ///< means; 0: not known
  int gaps_ = 0;                      ///< since the last frame that came when it was due
};

/// The same, shared between threads.
class FrameGaps {
 public:
  void arrived(std::uint64_t sequence);
  void planned(std::uint64_t sequence);
  /// No more frames come.
  void over();
  /// Waits, at most `most_s`, for the time to work for `work_s`. Returns how long it waited.
  double wait(double work_s, double most_s);

 private:
  session::Clock clock_;
  std::mutex mutex_;
  std::condition_variable news_;
  Rhythm rhythm_;
};

/// Waits during pictures that are drawn piece by piece.
class PictureSteps {
 public:
  /// Waits, at most `most_s`, for the time to work for `work_s`. Returns how long it waited.
  using LetRun = std::function<double(double work_s, double most_s)>;
  /// The clock must outlive this object.
  explicit PictureSteps(LetRun let_run, const session::Clock& clock = session::real_clock())
      : let_run_(std::move(let_run)), clock_(clock) {}

  /// Another picture: it waits for no more than most_s altogether.
  void begin();
  /// Before each piece: waits for the time for one that takes as long as that of the same number in pictures before.
  void pause();
  /// After the last; returns how long the picture has waited.
  double end();
  static constexpr double most_s = 0.1;

 private:
  void ends();

  LetRun let_run_;
  const session::Clock& clock_;
  std::vector<double> take_s_;  ///< means
  std::size_t next_ = 0;
  double begun_s_ = 0, waited_s_ = 0;
};

}  // namespace palpa::viewer
