// What the viewer knows of a session that runs beside it, as plain values. The session's threads write it down when the
// viewer is ready for another; the newest wins, and nothing of it grows with time.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "sensing/depth_source.hpp"
#include "sensing/skin_point.hpp"
#include "session/links/plan.hpp"
#include "touch/types.hpp"

namespace palpa::viewer {

/// How long frames took, counted: bin i holds those from i to i + 1 tenths of the budget, the last all that took
/// longer.
struct TimeBins {
  static constexpr double budget_s = 1.0 / 90;  ///< of a frame, at the cameras' 90 Hz
  std::array<std::uint32_t, 31> counts{};

  void add(double seconds);
  /// The time below which a share `p` of them lie, by the bins' upper ends.
  double quantile(double p) const;
  std::uint32_t total() const;
};

/// The time of one pass: of the last frame and on average over about the last fifty.
struct PassTimes {
  std::string name;
  double last_ms = 0, mean_ms = 0;
};

/// What a run has measured so far.
struct LiveNumbers {
  std::uint64_t frames = 0;    ///< looked at
  std::uint64_t touching = 0;  ///< of these with a finger
  std::uint64_t dropped = 0;   ///< left out between them, by the source's own numbers
  double rate_hz = 0;          ///< frames a second, lately
  double last_s = 0;           ///< frame in memory to drives in memory, of the last
  TimeBins bins;
  std::vector<PassTimes> passes;
};

/// One frame and what became of it.
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
  std::vector<sensing::SkinPoint> points;  ///< near the solids; indices ascend
};

}  // namespace palpa::viewer
