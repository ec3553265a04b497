// What the viewer knows of a running session, as plain values. The session's threads write a snapshot when the viewer
// is ready for another. The newest wins, and nothing in it grows with time.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "sensing/depth_source.hpp"
#include "sensing/skin_twin.hpp"
#include "session/plan/plan.hpp"
#include "touch/types.hpp"

namespace palpa::viewer {

/// A histogram of how long frames took. Bin i counts frames from i to i + 1 tenths of the budget, and the last bin all
/// that took longer.
struct TimeBins {
  static constexpr double budget_s = 1.0 / 90;  ///< of a frame, at the cameras' 90 Hz
  std::array<std::uint32_t, 31> counts{};

  void add(double seconds);
  /// The time below which a share `p` of the frames lies, by the bins' upper ends.
  double quantile(double p) const;
  std::uint32_t total() const;
};

/// The time of one pass, on average over about the last fifty frames.
struct PassTimes {
  std::string name;
  double mean_ms = 0;
};

/// What a run has measured so far.
struct LiveNumbers {
  std::uint64_t frames = 0;    ///< looked at
  std::uint64_t touching = 0;  ///< of these with a finger
  std::uint64_t dropped = 0;   ///< left out between them, according to the source's own numbers
  std::uint64_t thinned = 0;   ///< only some of their pixels were looked at, or only some of their foci play
  std::uint64_t outdated = 0;  ///< whose drives were ready only when they were no longer to sound
  double rate_hz = 0;          ///< recent frames per second
  double last_s = 0;           ///< of the last frame: from frame in memory to drives in memory
  TimeBins bins;
  std::vector<PassTimes> passes;
};

/// One frame and its results.
struct Snapshot {
  std::uint64_t sequence = 0;
  double time_s = 0;  ///< capture, on the source's clock
  touch::Touch touch;
  session::Plan plan;
  LiveNumbers numbers;
};

/// What the cameras saw; not always of the same frame as the newest snapshot.
struct Seen {
  std::uint64_t sequence = 0;
  sensing::FrameSet images;
  /// Near the solids, and the points there that are no skin, flying pixels among them. Indices ascend, in the latter
  /// within each kind.
  sensing::SkinOfFrame skin;
  std::string untouched;  ///< why nothing touches: how far the skin is from the solids; empty if something touches
};

}  // namespace palpa::viewer
