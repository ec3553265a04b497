// The part of a frame that a loop processes if the complete frame would take too long. Late sound is at a place that
// the finger has left, and a frame goes silent after its hold. So work is shed until the latency fits: first pixels,
// then foci. As long as it fits, nothing changes.
#pragma once

#include <cstdint>
#include <string>

namespace palpa::session {

struct Effort {
  std::uint32_t pixel_stride = 1;  ///< every n-th pixel of every n-th row may become a skin point
  std::uint32_t foci_part = 1;     ///< fingers have 1/n of their foci, but at least three
  bool operator==(const Effort&) const = default;
  bool whole() const { return *this == Effort{}; }
};

/// The limit to which `--hold auto` lengthens the hold.
inline constexpr double longest_auto_hold_s = 0.2;

/// Half of ten foci still make a circle; a third make a triangle.
inline constexpr std::uint32_t most_foci_part = 3;

/// The times of a frame whose drives are ready.
struct FrameTimes {
  double capture_to_plan_s = 0;  ///< from its capture to its drives in memory
  double work_s = 0;             ///< the part of that since its arrival
  double apart_s = 0;            ///< from the capture of the previously planned frame to its own capture
};

/// Decides the effort from the times only; any clock may be used.
///
/// A frame sounds until one hold after its capture. For sound without a gap, the next frame's drives must be ready by
/// then. They come later by the time between frames, or by the frame's work if that is shorter: leaving out work does
/// not make a slow camera faster. The latency and this time together may take four fifths of the hold. After three
/// frames in a row that take more, the next step is taken. A step is taken back after one second of frames that would
/// certainly have fitted without it, or after many frames that might have fitted. This number doubles each time the
/// step turns out to be needed.
class EffortControl {
 public:
  /// `most` is the maximum that can be shed; {1, 1}: nothing. If that is not enough, the hold may grow to
  /// `longest_hold_s`.
  EffortControl(double hold_s, const Effort& most, double longest_hold_s = 0)
      : default_hold_s_(hold_s), longest_hold_s_(longest_hold_s), hold_s_(hold_s), most_hold_s_(hold_s), most_(most) {}

  /// Returns true if the effort has changed.
  bool planned(const FrameTimes& frame);
  const Effort& now() const { return now_; }
  /// The least effort so far.
  const Effort& least() const { return least_; }
  /// The current hold, and the longest hold so far.
  double hold_s() const { return hold_s_; }
  double most_hold_s() const { return most_hold_s_; }
  /// Whether any work was shed or the hold was lengthened.
  bool acted() const { return !least_.whole() || most_hold_s_ > default_hold_s_; }
  /// From the capture of a frame to the drives of the next one, when that was first too long.
  double late_s() const { return late_s_; }
  /// Frames in a row since the last change.
  std::uint32_t steady() const { return steady_; }
  /// Whether nothing more can be shed.
  bool exhausted() const { return now_ == most_ && hold_s_ >= longest_hold_s_; }
  /// The number of frames that were processed only in part.
  std::uint64_t shed_frames() const { return shed_frames_; }

  static constexpr double most_of_hold = 0.8;  ///< above it, work is shed
  static constexpr double calm_below = 0.4;    ///< frames that take less might fit without the last step
  /// Frames below this certainly fit without the last step, even if that step affects all of their work.
  static constexpr double sure_below = 0.6;
  static constexpr std::uint32_t late_frames = 3;  ///< in a row, before work is shed
  static constexpr std::uint32_t settle = 4;       ///< frames ignored after a change, because they began before it
  static constexpr std::uint32_t first_calm = 90, longest_calm = 90 << 9;

 private:
  bool shed(double reach_s);
  bool take_back();
  double more_without_last_step() const;

  double default_hold_s_, longest_hold_s_, hold_s_, most_hold_s_, late_s_ = 0;
  Effort most_, now_, least_;
  std::uint32_t steady_ = 0, late_ = 0, calm_ = 0, sure_ = 0;
  std::uint32_t calm_needed_ = first_calm;
  bool taken_back_ = false;  ///< the last change took a step back
  std::uint64_t shed_frames_ = 0;
};

/// The work that was left out, as part of a line: "only every 2nd pixel of every 2nd row was looked at".
std::string to_text(const Effort& effort);

/// Reports once what was shed and what would help, when the effort has not changed for a while or at the end.
class ShedReport {
 public:
  explicit ShedReport(double hold_s) : hold_s_(hold_s) {}
  void planned(const EffortControl& control);
  void end(const EffortControl& control);

 private:
  void tell(const EffortControl& control);

  static constexpr std::uint32_t a_while = 32;
  double hold_s_;
  bool told_ = false;
};

}  // namespace palpa::session
