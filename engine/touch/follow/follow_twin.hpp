// Fingers keep their identity, and their axes, from frame to frame. The rules are in docs/touch.md.
#pragma once

#include <array>
#include <cstdint>

#include "shaders/touch/follow/follow.h"
#include "touch/follow/frame_clock.hpp"
#include "touch/stage_setting.hpp"
#include "touch/types.hpp"

namespace palpa::touch {

/// The fingers of the frames before. One for each stream of frames.
struct Tracks {
  FrameClock clock;
  std::uint32_t count = 0;
  std::uint32_t next_id = 0;
  std::array<shader::Track, shader::follow_most_tracks> tracks{};
};

/// C++ twin of FollowPass. Gives the first `finger_count` fingers of a frame, whose sections are those of
/// find_sections, their ids, and where the setting has steady axes turns them the least they can from those of the
/// frame before. Ids count up from 0 in the order of the fingers and are never used twice. In the first frame ids are
/// the fingers' order. The first tracks are then those of the fingers. Same single-precision arithmetic as in the pass.
/// Allocates nothing.
void follow_fingers(Tracks& tracks, double time_s, const StageSetting& setting, Touch& touch);

}  // namespace palpa::touch
