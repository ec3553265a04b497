// Values of a running session that another thread may change at any time: how loud it is, and where its solids are.
#pragma once

#include <atomic>
#include <cstdint>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/math.hpp"
#include "session/loop/run_observer.hpp"
#include "session/newest.hpp"
#include "session/session.hpp"

namespace palpa::session {

/// What may change about a solid; what is empty is as the scene says.
struct SolidValues {
  std::optional<Transform> T_world_rest{};  ///< see Session::set_pose
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
  /// Changes the values of the solids of that name: `change` returns whether it has changed any. Returns false if the
  /// scene has no such solid.
  template <typename Change>
  bool change(std::string_view solid, Change change) {
    if (!knows(solid)) return false;
    Named& named = values_of(solid);
    if (!change(named.values)) return true;
    named.change = ++changes_;
    newest_.back() = values_;
    newest_.publish();
    return true;
  }

  // ---- the loop's

  /// For Safety::gain_now: the gain, and 0 while it is muted. The next drive follows it.
  const std::atomic<double>& factor() const { return factor_; }
  /// The scene has these solids from now on: all values hold for them. To be called before the first change().
  void set_solids(std::span<const std::string> names);
  /// Gives the session what has changed, and reports it to the observer.
  void apply(Session& session, RunObserver& observer = no_observer);

 private:
  struct Named {
    std::string solid;
    std::uint64_t change = 0;  ///< the number of the last one
    SolidValues values;
  };

  bool knows(std::string_view solid);
  Named& values_of(std::string_view solid);

  // The writing thread's.
  double gain_ = 1;
  bool muted_ = false;
  std::uint64_t changes_ = 0;
  std::vector<Named> values_;

  std::atomic<double> factor_{1};
  Newest<std::vector<Named>> newest_;
  std::mutex mutex_;
  std::vector<std::string> names_;

  std::uint64_t applied_ = 0;  ///< the loop's: the newest change that the session has
  bool again_ = false;         ///< the loop's: the session has another scene
};

}  // namespace palpa::session
