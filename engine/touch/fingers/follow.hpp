// Fingers keep their identity and their axes from frame to frame. The rules are in docs/touch-frames.md.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "touch/fingers/follow_math.hpp"
#include "touch/stage_setting.hpp"
#include "touch/types.hpp"

namespace palpa::touch {

/// The time from frame to frame.
class FrameClock {
 public:
  /// Microseconds from the capture time of the previous call's frame to `time_s`; follow_restart for the first
  /// call. If the time goes backwards, following restarts: the result is then longer than any finger is remembered.
  std::uint32_t elapsed_us(double time_s);

 private:
  std::optional<double> last_s_;
};

/// The fingers of earlier frames. One object for each stream of frames.
struct Tracks {
  FrameClock clock;
  std::uint32_t count = 0;
  std::uint32_t next_id = 0;
  std::array<Track, follow_most_tracks> tracks{};
  /// The places of the contacts of the frame's fingers, whose tracks are the first; and of the frame before.
  struct Skin {
    std::uint32_t fingers = 0;
    std::array<std::vector<Float3>, max_fingers> places{};
  } skin, skin_before;
};

/// Gives ids to the first `finger_count` fingers of a frame, whose sections come from find_sections(). If the setting
/// has steady axes, turns their axes as little as possible from those of the previous frame. Ids count up from 0 in the
/// order of the fingers and are never reused. In the first frame, the ids are the fingers' order. After each call, the
/// first tracks are those of the frame's fingers, in their order. `elapsed_us` comes from the tracks' clock.
void follow_fingers(Tracks& tracks, std::uint32_t elapsed_us, const StageSetting& setting, Touch& touch);

}  // namespace palpa::touch
