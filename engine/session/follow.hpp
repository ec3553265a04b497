// Fingers keep their identity from frame to frame.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "touch/types.hpp"

namespace palpa::session {

/// Gives every finger of a frame an id: that of the nearest finger of the frame before on the same solid, the closest
/// pairs first, if it is not farther than `reach_m`; otherwise a new one. Ids count up from 0 and are never used twice.
class Follower {
 public:
  /// 1.8 m/s at 90 frames per second: few fingers are faster, and neighbouring fingertips are about that far apart.
  static constexpr float reach_m = 0.02f;

  /// Sets the fingers' ids, and gives them in their order, valid until the next call. Allocates nothing.
  std::span<const std::uint32_t> follow(touch::Touch& touch);

 private:
  struct Followed {
    std::uint32_t id = 0;
    std::uint32_t solid = 0;
    glm::vec3 centroid{};
  };
  std::array<Followed, touch::max_fingers> before_{};
  std::uint32_t before_count_ = 0;
  std::array<std::uint32_t, touch::max_fingers> ids_{};
  std::uint32_t next_id_ = 0;
};

}  // namespace palpa::session
