// Values of a running session that another thread may change at any time: how loud it is, where its solids are, and how
// they feel.
#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/math.hpp"
#include "session/loop/run_observer.hpp"
#include "session/newest.hpp"
#include "session/plan/feel.hpp"
#include "session/session.hpp"

namespace palpa::session {

/// What may change about a solid; what is empty is as the scene says.
struct SolidValues {
  std::optional<Transform> T_world_rest{};  ///< see Session::set_pose
  FeelChange feel{};                        ///< see Session::change_feel
};

/// One thread writes, and the loop's thread takes the newest values at the start of a frame. Neither waits for the
/// other. Values belong to names, so they stay when the scene is read again.
class LiveValues {
 public:
  // ---- the writing thread's

  /// 0..1
  void set_gain(double gain) {
    gain_ = gain;
    factor_ = muted_ ? 0.0 : gain_;
  }
  void mute(bool muted) {
    muted_ = muted;
    factor_ = muted_ ? 0.0 : gain_;
  }
  /// Changes the values of the solids of that name; what is empty in `values` stays. Returns why they cannot change, as
  /// the end of a sentence about them; empty if they do.
  std::string_view change(std::string_view solid, const SolidValues& values);

  // ---- the loop's

  /// For Safety::gain_now: the gain, and 0 while it is muted. The next drive follows it.
  const std::atomic<double>& factor() const { return factor_; }
  /// The session has its scene from now on: all values hold for its solids. To be called before the first change().
  void set_scene(const Session& session);
  /// Gives the session what has changed, and reports it to the observer.
  void apply(Session& session, RunObserver& observer = no_observer);

 private:
  struct Named {
    std::string solid;
    std::uint64_t moved = 0, felt = 0;  ///< the numbers of the last changes of its pose and of its feel
    SolidValues values;
  };
  struct Known {
    std::string solid;
    bool may_press = false;  ///< has a press depth
  };

  Named& values_of(std::string_view solid);

  // The writing thread's.
  double gain_ = 1;
  bool muted_ = false;
  std::uint64_t changes_ = 0;
  std::vector<Named> values_;

  std::atomic<double> factor_{1};
  Newest<std::vector<Named>> newest_;
  std::mutex mutex_;
  std::vector<Known> known_;  ///< the solids of the scene
  GainPace pace_;             ///< of the scene

  std::uint64_t applied_ = 0;  ///< the loop's: the newest change that the session has
  bool again_ = false;         ///< the loop's: the session has another scene
};

}  // namespace palpa::session
