// Follows a hand for a sensation that plays on it: a joint of a tracker's hand, or the finger that touches a solid.
#pragma once

#include <memory>
#include <span>
#include <string>

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

class HandFollower {
 public:
  virtual ~HandFollower() = default;
  /// Ends, and throws what went wrong meanwhile. When the source ends or fails, `stop` becomes true.
  virtual void end() = 0;
};

/// Opens the source of `frames` and follows the hand on a thread of its own, with times of `clock`. `anchor` gets its
/// pose in the frame of the array, which stands at `T_world_array`. If there are several hands, it stays with one as
/// long as that is there. Throws as open_tracker and prepare() do, and bad_usage for a source that does not go with
/// `on`.
std::unique_ptr<HandFollower> follow_hand(On on, const FrameOptions& frames,
                                          std::span<const session::SourceKind> sources, const Transform& T_world_array,
                                          session::Anchor& anchor, std::atomic<bool>& stop,
                                          const session::Clock& clock = session::real_clock());

}  // namespace palpa::setup
