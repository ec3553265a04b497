// How much of a frame a loop works on where all of it would take too long: sound that comes late shows a place where
// the finger is no more, and what a frame shows is silent once it is over. So work is shed until the latency fits:
// first pixels, then foci. While it fits nothing is changed.
#pragma once

#include <cstdint>
#include <string>

namespace palpa::session {

struct Effort {
  std::uint32_t pixel_stride = 1;  ///< every n-th pixel of every n-th row may become a skin point
  std::uint32_t foci_part = 1;     ///< fingers have an n-th of their foci, three at least
  bool operator==(const Effort&) const = default;
  bool whole() const { return *this == Effort{}; }
};

/// `--hold auto` lengthens the hold no further than this.
inline constexpr double longest_auto_hold_s = 0.2;

/// Half of ten foci are still a circle, a third is a triangle.
inline constexpr std::uint32_t most_foci_part = 3;

/// What a frame took whose drives are there.
struct FrameTimes {
  double capture_to_plan_s = 0;  ///< from its capture to its drives in memory
  double work_s = 0;             ///< of that, since it arrived
  double apart_s = 0;            ///< from the capture of the frame that was planned before to its own
};

/// Decides the effort from the times alone, whatever clock they are of.
///
/// A frame sounds until a hold after its capture. For sound without a gap the next frame's drives must be there by
/// then, which is one frame's time later, or the frame's work where that takes longer. Both together may take
/// four fifths of the hold; three frames in a row that take more are answered by the next step. A step is taken back
/// after a second of frames that would surely have fitted without it, or after many that may have: twice as many each
/// time that it turns out to be needed.
class EffortControl {
 public:
  /// `most` is what can be shed at all; {1, 1}: nothing. Where that is not enough the hold may grow to
  /// `longest_hold_s`.
  EffortControl(double hold_s, const Effort& most, double longest_hold_s = 0)
      : usual_hold_s_(hold_s), longest_hold_s_(longest_hold_s), hold_s_(hold_s), most_hold_s_(hold_s), most_(most) {}

  /// True: the effort has changed.
  bool planned(const FrameTimes& frame);
  const Effort& now() const { return now_; }
  /// The least that was worked on so far.
  const Effort& least() const { return least_; }
  /// How long a frame may sound now, and the longest that it was.
  double hold_s() const { return hold_s_; }
  double most_hold_s() const { return most_hold_s_; }
  /// Whether anything was shed, or the hold lengthened.
  bool acted() const { return !least_.whole() || most_hold_s_ > usual_hold_s_; }
  /// Frames in a row since it has changed.
  std::uint32_t steady() const { return steady_; }
  /// Whether there is nothing more to shed.
  bool exhausted() const { return now_ == most_ && hold_s_ >= longest_hold_s_; }
  /// Frames that were worked on in part.
  std::uint64_t shed_frames() const { return shed_frames_; }

  static constexpr double most_of_hold = 0.8;      ///< beyond it work is shed
  static constexpr double calm_below = 0.4;        ///< frames that take less may be calm without the last step, too
  static constexpr double sure_below = 0.6;        ///< if all work is what the last step shed: then they are
  static constexpr std::uint32_t late_frames = 3;  ///< in a row
  static constexpr std::uint32_t settle = 4;       ///< frames that were begun before a change
  static constexpr std::uint32_t first_calm = 90, longest_calm = 90 << 9;

 private:
  bool shed(double reach_s);
  bool take_back();
  double more_without_last_step() const;

  double usual_hold_s_, longest_hold_s_, hold_s_, most_hold_s_;
  Effort most_, now_, least_;
  std::uint32_t steady_ = 0, late_ = 0, calm_ = 0, sure_ = 0;
  std::uint32_t calm_needed_ = first_calm;
  bool taken_back_ = false;  ///< the last change was one back
  std::uint64_t shed_frames_ = 0;
};

/// What was left out, as part of a line: "only every 2nd pixel of every 2nd row was looked at".
std::string to_text(const Effort& effort);

/// Tells once what was shed, and what would help: when the effort has not changed for a while, or at the end.
class ShedReport {
 public:
  explicit ShedReport(double hold_s) : hold_s_(hold_s) {}
  void planned(const EffortControl& control, double capture_to_plan_s);
  void end(const EffortControl& control);

 private:
  void tell(const EffortControl& control);

  static constexpr std::uint32_t a_while = 32;
  double hold_s_, whole_s_ = 0;
  bool told_ = false;
};

}  // namespace palpa::session
