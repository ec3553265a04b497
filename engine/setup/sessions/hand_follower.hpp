// Follows a hand for a sensation that plays on it: a joint of a tracker's hand, or the finger that touches a solid.
#pragma once

#include <atomic>
#include <exception>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <thread>

#include "base/math.hpp"
#include "base/words.hpp"
#include "session/clock.hpp"
#include "session/links/sources.hpp"
#include "session/sensation_run.hpp"
#include "setup/sessions/frames.hpp"

namespace palpa::setup {

/// Where on a hand a sensation plays: a joint, the tip of a finger, or where a finger touches a solid.
enum class On { palm, wrist, thumb, index, middle, ring, little, finger };
inline constexpr Word<On> on_words[] = {{"palm", On::palm},     {"wrist", On::wrist},   {"thumb", On::thumb},
                                        {"index", On::index},   {"middle", On::middle}, {"ring", On::ring},
                                        {"little", On::little}, {"finger", On::finger}};

/// Follows a hand on a thread of its own. When that ends or fails, there is no hand, and `stop` becomes true.
class HandFollower {
 public:
  using Follow = std::function<void(std::atomic<bool>& over)>;
  HandFollower(Follow follow, session::HandPlace& place, std::atomic<bool>& stop,
               const session::Clock& clock = session::real_clock());
  ~HandFollower();
  HandFollower(const HandFollower&) = delete;
  HandFollower& operator=(const HandFollower&) = delete;
  /// Ends, and throws what went wrong meanwhile.
  void end();

 private:
  std::atomic<bool> over_{false};
  std::exception_ptr fault_;
  std::thread thread_;
};

/// Opens the source of `frames`, whose hand a HandFollower follows from its own beginning on, with times of `clock`.
/// `place` gets its pose in the frame of the array, which stands at `T_world_array`. If there are several hands, it
/// stays with one as long as that is there. Throws as open_tracker and prepare() do, and bad_usage for a source that
/// does not go with `on`.
HandFollower::Follow open_hand(On on, const FrameOptions& frames, std::span<const session::SourceKind> sources,
                               const Transform& T_world_array, session::HandPlace& place,
                               const session::Clock& clock = session::real_clock());

}  // namespace palpa::setup
