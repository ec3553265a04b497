// Two fingertips that move on a plate in front of depth cameras, and how they are followed.
#pragma once

#include <array>
#include <functional>
#include <glm/vec3.hpp>
#include <vector>

#include "sensing/depth_source.hpp"
#include "touch/harness.hpp"

namespace palpa::touch::test {

/// The places of the two tips on the plate (x, z) at a time, from 0 to `seconds`.
struct Walk {
  double seconds = 0;
  std::function<std::array<Vec3, 2>(double time_s)> tips;
};

/// Past each other along x at `speed` each; their tracks are `aside` apart.
Walk crossing(double speed, double rate_hz, double aside);
/// Towards each other, slowing down, together for `hold_s` with their tips 13 mm apart, and back again.
Walk bouncing(double speed, double rate_hz, double hold_s);

/// The plate that they touch: its top is y = 0.
std::vector<geometry::Solid> plate();

/// The images of the first `cameras` of the paper's rig, with the D415's faults.
std::vector<sensing::FrameSet> film(const Walk& walk, int cameras, double rate_hz, std::uint64_t seed);

/// A finger of a frame.
struct Sighting {
  double time_s = 0;
  glm::vec3 centroid{};
  std::uint32_t id = 0;
  std::array<bool, 2> skin{};  ///< the fingers whose contacts it has, at least a fifth of them each
  bool both() const { return skin[0] && skin[1]; }
};

/// Follows the fingers through the frames.
std::vector<Sighting> follow(const Walk& walk, const std::vector<sensing::FrameSet>& frames, int cameras);

}  // namespace palpa::touch::test
