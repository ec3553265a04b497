// Decides whether a frame is started while the previous one is still being computed.
//
// A GPU may overlap the two, so a frame that does not wait has its drives sooner. If the two frames only share the
// hardware, for example two cores that are also the device, both are late, each by about the time of both together.
// Late drives may then expire before they sound. So the effect is measured: for frames that came while another was
// being computed, the time from arrival to drives is compared between early and normal starts.
#pragma once

#include <cstdint>

namespace palpa::session {

class EarlyStart {
 public:
  /// No trial is made if a frame that takes twice as long would expire before it sounds.
  explicit EarlyStart(double hold_s) : hold_s_(hold_s) {}

  /// Whether the next frame that comes while another is being computed should be started at once.
  bool now() const { return trial_left_ > 0 ? !early_ : early_; }

  /// Reports a frame that came while another was being computed: its drives were ready `taken_s` after its arrival.
  /// `early`: it was started at once.
  void took(double taken_s, bool early);

 private:
  /// Frames in a row. The first one is still affected by the previous mode.
  static constexpr std::uint32_t trial = 4;
  /// Frames from one trial to the next; doubled after each trial that changed nothing.
  static constexpr std::uint64_t first_pause = 32, longest_pause = 1 << 15;
  /// Frames are started early only if their drives are then ready within this part of the normal time.
  static constexpr double gain = 0.95;

  bool is_trial_due() const;
  void begin_trial();
  void end_trial();

  double hold_s_;
  bool early_ = false;  ///< the mode between trials
  double usual_s_ = 0;  ///< the average time in this mode, weighted towards newer frames
  std::uint64_t usual_count_ = 0;
  double other_s_ = 0;  ///< the time in the other mode, when last measured
  std::uint32_t trial_left_ = 0;
  double trial_sum_s_ = 0;
  std::uint64_t pause_ = first_pause, since_trial_ = 0;
};

}  // namespace palpa::session
