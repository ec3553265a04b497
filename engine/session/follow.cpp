#include "session/follow.hpp"

#include <glm/geometric.hpp>

namespace palpa::session {

std::span<const std::uint32_t> Follower::follow(touch::Touch& touch) {
  const std::uint32_t count = touch.finger_count;
  std::array<bool, touch::max_fingers> known{}, taken{};
  // At most 64 fingers: looking for the closest pair again and again is quicker than sorting all pairs.
  for (;;) {
    float closest = reach_m;
    std::uint32_t finger = count, former = 0;
    for (std::uint32_t f = 0; f < count; ++f) {
      if (known[f]) continue;
      for (std::uint32_t b = 0; b < before_count_; ++b) {
        if (taken[b] || before_[b].solid != touch.fingers[f].solid) continue;
        const float apart = glm::distance(before_[b].centroid, touch.fingers[f].section.centroid);
        if (apart < closest) {
          closest = apart;
          finger = f;
          former = b;
        }
      }
    }
    if (finger == count) break;
    known[finger] = taken[former] = true;
    ids_[finger] = before_[former].id;
  }
  for (std::uint32_t f = 0; f < count; ++f) {
    if (!known[f]) ids_[f] = next_id_++;
    touch.fingers[f].id = ids_[f];
    before_[f] = {ids_[f], touch.fingers[f].solid, touch.fingers[f].section.centroid};
  }
  before_count_ = count;
  return {ids_.data(), count};
}

}  // namespace palpa::session
