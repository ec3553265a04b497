// What a stage of touching is told, once: when it is made.
#pragma once

#include <algorithm>
#include <cstdint>

#include "touch/types.hpp"

namespace palpa::touch {

/// Shorter than what FrameClock makes of a clock that is set back.
inline constexpr double longest_memory_s = 3600;

struct StageSetting {
  Parameters parameters;
  Detail detail = Detail::contacts;
  /// Fingers keep their ids from frame to frame: frames come in the order of their capture. Otherwise each frame stands
  /// alone, and the next three say nothing.
  bool follow = false;
  Axes axes = Axes::steady;
  Smoothing smoothing = Smoothing::one_euro;
  /// A finger that nobody sees is remembered that long, at least 0.3 s: no shorter than frames may be apart.
  double memory_s = 0;

  std::uint32_t memory_us() const {
    return static_cast<std::uint32_t>(std::clamp(memory_s, 0.3, longest_memory_s) * 1e6);
  }
  bool glides() const { return follow && smoothing == Smoothing::one_euro; }
  /// Whether depth frames, where there are `cameras`, say which clusters are fingers: what is several is split, patches
  /// are joined across hidden skin.
  bool looks_again(bool cameras) const { return cameras && parameters.finger_width_m > 0; }

  // On the device only, most of what one frame has; more is an error that read() reports. 0: the stage decides. With
  // cameras it has room for every pixel, and for 262,144 contacts; points from elsewhere get as much room as they need,
  // be they all contacts.
  std::uint32_t most_points = 0;  ///< at most shader::contacts_most_points
  std::uint32_t most_contacts = 0;
};

}  // namespace palpa::touch
