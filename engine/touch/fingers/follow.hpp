// Fingers keep their identity and their axes from frame to frame. The rules are in docs/touch-frames.md.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "touch/fingers/exact.hpp"
#include "touch/stage_setting.hpp"
#include "touch/types.hpp"

namespace palpa::touch {

/// An unseen finger is assumed to move on for this time.
inline constexpr std::uint32_t coasting_us = 100000;

/// The time from frame to frame.
class FrameClock {
 public:
  /// Microseconds from the capture time of the previous call's frame to `time_s`; nothing for the first call. If the
  /// time goes backwards, following restarts: the result is then longer than any finger is remembered.
  std::optional<std::uint32_t> elapsed_us(double time_s);

 private:
  std::optional<double> last_s_;
};

/// The data on a finger, present or past.
struct Track {
  std::uint32_t id = 0;
  std::uint32_t solid = 0;
  std::optional<std::uint32_t> carrier{};  ///< the track into whose cluster this one has merged
  std::uint32_t unseen_us = 0;  ///< since it was last seen, by itself or in a cluster that looks like two fingers
  bool left_home = false;       ///< it has been in another's cluster since it was last seen by itself
  std::uint32_t home = 0;  ///< 0 to most_tracks - 1, fixed as long as the track is known: its foci's data are there
  glm::vec3 place{};       ///< where its centroid is, or is expected
  float stray = 0;         ///< distance from there to the centroid of its cluster
  glm::vec3 velocity{};    ///< m/s
  bool has_axes = false;
  glm::vec3 axis1{}, axis3{};  ///< steady w1 and w3
  // When it was last seen by itself:
  std::uint32_t contacts = 0;
  glm::mat3 covariance{};
  // Known only for the fingers of this frame:
  /// Time since it was last seen by itself. Nothing: it is new, was in another's cluster since then, or was missing for
  /// longer than it coasts.
  std::optional<std::uint32_t> since_us{};
  glm::vec3 joined{};  ///< how far contacts that joined or left moved its centroid
};

/// The fingers of earlier frames. One object for each stream of frames.
struct Tracks {
  static constexpr std::uint32_t most = 128;

  FrameClock clock;
  std::uint32_t count = 0;
  std::uint32_t next_id = 0;
  std::array<Track, most> tracks{};  ///< the first are those of the frame's fingers, in their order
  /// The places of the contacts of the frame's fingers, and of the frame before.
  struct Skin {
    std::uint32_t fingers = 0;
    std::array<std::vector<glm::vec3>, max_fingers> places{};
  } skin, skin_before;
};

/// Gives ids to the first `finger_count` fingers of a frame, whose sections come from find_sections(). If the setting
/// has steady axes, turns their axes as little as possible from those of the previous frame. Ids count up from 0 in the
/// order of the fingers and are never reused. In the first frame, the ids are the fingers' order. After each call, the
/// first tracks are those of the frame's fingers, in their order. `elapsed_us` comes from the tracks' clock; without
/// it, no finger of an earlier frame is known.
void follow_fingers(Tracks& tracks, std::optional<std::uint32_t> elapsed_us, const StageSetting& setting, Touch& touch);

}  // namespace palpa::touch
