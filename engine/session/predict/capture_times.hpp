// Looks for capture times that cannot be those of a camera, and reports each kind once.
#pragma once

#include <cstdint>

namespace palpa::session {

/// Only reports. What becomes of such frames is decided elsewhere: fingers are followed from the start again
/// (touch/fingers/follow.hpp), nothing is predicted (motion_filter.hpp), and the hold ends the sound.
class CaptureTimes {
 public:
  /// The next frame: captured at `time_s` on the source's clock, arrived at `arrived_s` on another clock, with an age
  /// of `age_s` as far as it is known. Frames of a recording that is played as fast as it goes have no arrival: then
  /// only the order of times is looked at.
  void see(double time_s, double arrived_s, double age_s);
  void see(double time_s);
  /// Whether it is a time at all. A frame without one has no age, so it must not sound.
  bool is_time(double time_s);

  /// Beyond the time that has passed between two arrivals. A frame that waited in the source's queue, for example
  /// because palpa was starting, is followed by one that is seconds newer. That is no fault.
  static constexpr double longest_jump_s = 30;
  static constexpr double longest_gap_s = 600;    ///< if no arrival is known
  static constexpr std::uint32_t most_equal = 3;  ///< frames in a row with one time
  /// A busy machine delays single frames. Only if more than most_late of late_among frames in a row are too old for
  /// their prediction is that reported.
  static constexpr std::uint32_t most_late = 5, late_among = 50;

 private:
  void report(bool& reported, double from_s, double to_s, const char* what);

  bool known_ = false;
  double time_s_ = 0, arrived_s_ = 0;
  std::uint32_t equal_ = 1, late_count_ = 0, looked_at_ = 0;
  bool back_ = false, still_ = false, jumped_ = false, late_ = false, missing_ = false;
};

}  // namespace palpa::session
