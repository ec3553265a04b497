// Whether a frame is started while the one before is still under way.
//
// A GPU may overlap the two: then a frame that need not wait has its drives sooner. Where they only share what there is
// - two cores that are the device as well - both come later, each about as late as the two together, and what late
// drives show may be over before it sounds. Which of them holds is measured: frames that came while another was under
// way tell how long it took from their arrival to their drives, started early or not.
#pragma once

#include <cstdint>

namespace palpa::session {

class EarlyStart {
 public:
  /// No trial where a frame that takes twice as long would be over before it sounds.
  explicit EarlyStart(double hold_s) : hold_s_(hold_s) {}

  /// Whether the next frame that comes while another is under way should be started at once.
  bool now() const { return trial_left_ > 0 ? !early_ : early_; }

  /// The drives of a frame that came while another was under way, `early`: and was started then, are there `taken_s`
  /// after it arrived.
  void took(double taken_s, bool early);

 private:
  /// Frames in a row, the first of which still has to do with how it was before.
  static constexpr std::uint32_t trial = 4;
  /// Frames from one trial to the next; twice as many after each that changed nothing.
  static constexpr std::uint64_t first_pause = 32, longest_pause = 1 << 15;
  /// How much sooner drives must be there for frames to be started early: else they wait.
  static constexpr double gain = 0.95;

  bool is_trial_due() const;
  void begin_trial();
  void end_trial();

  double hold_s_;
  bool early_ = false;  ///< what is done between trials
  double usual_s_ = 0;  ///< how long it takes so, newer frames counting more
  std::uint64_t usual_count_ = 0;
  double other_s_ = 0;  ///< how long it took the other way, when that was last measured
  std::uint32_t trial_left_ = 0;
  double trial_sum_s_ = 0;
  std::uint64_t pause_ = first_pause, since_trial_ = 0;
};

}  // namespace palpa::session
