#include "session/loop/early_start.hpp"

#include <algorithm>
#include <utility>

namespace palpa::session {

void EarlyStart::took(double taken_s, bool early) {
  if (early != now()) return;  // started before the mode changed
  if (trial_left_ > 0) {
    if (trial_left_ < trial) trial_sum_s_ += taken_s;
    if (--trial_left_ == 0) end_trial();
    return;
  }
  constexpr double newest = 0.1;
  usual_s_ += (taken_s - usual_s_) * std::max(newest, 1.0 / static_cast<double>(++usual_count_));
  ++since_trial_;
  if (is_trial_due()) begin_trial();
}

bool EarlyStart::is_trial_due() const {
  if (!early_) return since_trial_ >= pause_ && 2 * usual_s_ < hold_s_;
  // After the shorter pause if the gain is gone: another program may be using the device now.
  return since_trial_ >= (usual_s_ < other_s_ ? pause_ : first_pause);
}

void EarlyStart::begin_trial() {
  trial_left_ = trial;
  trial_sum_s_ = 0;
}

void EarlyStart::end_trial() {
  since_trial_ = 0;
  const double tried_s = trial_sum_s_ / (trial - 1);
  const bool better = early_ ? tried_s * gain <= usual_s_ : tried_s < usual_s_ * gain;
  if (!better) {
    other_s_ = tried_s;
    pause_ = std::min(2 * pause_, longest_pause);
    return;
  }
  early_ = !early_;
  other_s_ = std::exchange(usual_s_, tried_s);
  usual_count_ = trial - 1;
  pause_ = first_pause;
}

}  // namespace palpa::session
