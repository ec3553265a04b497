// How long a loop waits for a guard that takes nothing: it is stopped, or hangs.
#pragma once

#include <algorithm>
#include <utility>

namespace palpa::driver {

class Patience {
 public:
  static constexpr double most_s = 1;

  /// The loop sends a drive in every slot after `now_s`. All times are on one clock.
  Patience(double slot_s, double now_s) : slot_s_(slot_s), sent_s_(now_s) {}

  /// Whether the guard must be killed. A drive was sent at `now_s`; `unread`: the guard had not taken the one before. A
  /// step counts as two slots at most, so that a loop that was stopped together with the guard does not blame the
  /// guard.
  bool ends(bool unread, double now_s) {
    const double step_s = std::min(now_s - std::exchange(sent_s_, now_s), 2 * slot_s_);
    unread_s_ = unread ? unread_s_ + step_s : 0;
    return unread_s_ >= most_s;
  }

 private:
  double slot_s_, sent_s_, unread_s_ = 0;
};

}  // namespace palpa::driver
