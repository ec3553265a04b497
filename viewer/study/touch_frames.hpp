// What became of the frames of a touch: which of them had skin over the object, and which of these were not felt as
// they should have been.
#pragma once

#include <cstdint>
#include <deque>
#include <mutex>
#include <optional>

#include "session/clock.hpp"
#include "session/loop/run_observer.hpp"

namespace palpa::viewer {

/// Frames with skin over the object. Each counts in `skin`, and in at most one of the others.
struct FrameCounts {
  std::uint64_t skin = 0;
  std::uint64_t thinned = 0;   ///< only some of their pixels were looked at, or only some of their foci played
  std::uint64_t outdated = 0;  ///< their drives were ready only when they were no longer to sound
  /// A newer frame took their place, the gate was closed because nobody knew how deep the finger was, or no drive of
  /// them reached the array.
  std::uint64_t left_out = 0;
  bool operator==(const FrameCounts&) const = default;
};

/// Counts from what a session, its link and the search for skin report, on any thread. A frame is judged when it could
/// sound no longer: a hold after it came. Those that came less than a hold before the end of the touch do not count.
///
/// Skin is looked for in only some of the frames. The others have skin over the object if those before and after them
/// have. Frames with a point that is too deep do not count, because nothing is to be played for them.
class TouchFrames final : public session::RunObserver {
 public:
  explicit TouchFrames(const session::Clock& clock) : clock_(&clock) {}

  /// A touch begins, in which each frame is to sound for `hold_s`. Forgets the touch before.
  void begin(double hold_s);
  /// The touch is over, or it was broken off.
  void end();
  /// The counts of the touch under way, or of the last one.
  FrameCounts counts() const;

  /// A frame has come. Frames were left out if its number is further from the one before than any two of this source
  /// were so far.
  void arrived(std::uint64_t sequence) override;
  void planned(const session::FrameReport& report, const session::Plan& plan) override;
  /// A drive of the plan with fingers of that time (array::Schedule::time_s) was let through. `reached`: drives have
  /// reached the array since the one before, or the link does not count them.
  void passed(double time_s, bool sounds, bool reached);
  /// What a frame shows: skin `over` the object, or too `deep` in it. Numbers ascend.
  void seen(std::uint64_t sequence, bool over, bool deep);

 private:
  struct Frame {
    std::uint64_t sequence = 0;
    double arrived_s = 0;
    std::optional<double> time_s{};  ///< of its plan
    bool thinned = false, outdated = false;
    bool fingers = false;               ///< there are foci to be played
    bool passed = false;                ///< a drive of it was let through
    bool sounded = false;               ///< one that sounds
    bool reached = false;               ///< and drives reached the array meanwhile
    std::optional<bool> over_object{};  ///< nothing as long as no later frame was seen
  };
  struct Seen {
    std::uint64_t sequence = 0;
    bool counts = false;  ///< skin over the object, and not too deep
  };
  static void add(const Frame& frame, FrameCounts& counts);
  void judge(double now_s);

  const session::Clock* clock_;
  mutable std::mutex mutex_;
  bool touching_ = false;
  double hold_s_ = 0;
  std::deque<Frame> waiting_;             ///< that are not judged yet, by number
  std::optional<std::uint64_t> last_{};   ///< the number of the newest frame
  std::optional<std::uint64_t> apart_{};  ///< the least distance between the numbers of two frames
  std::optional<Seen> seen_;
  FrameCounts counts_;
};

}  // namespace palpa::viewer
