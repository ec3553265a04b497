#include "touch/follow.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "shaders/follow_math.h"
#include "spirv/follow.comp.hpp"

namespace palpa::touch {

static_assert(shader::follow_most_tracks >= 2 * max_fingers);

std::uint32_t FrameClock::elapsed_us(double time_s) {
  const double elapsed = last_s_ ? (time_s - *last_s_) * 1e6 : 0;
  const bool first = !last_s_;
  last_s_ = time_s;
  if (first) return shader::follow_anew;
  constexpr double forever = 4e9;
  return static_cast<std::uint32_t>(elapsed >= 0 && elapsed < forever ? std::llround(elapsed) : std::llround(forever));
}

FollowPass::FollowPass(const gpu::Device& device)
    : pipeline_(device, "follow", spirv::follow_comp, {shader::follow_buffers, sizeof(shader::FollowPush)}) {}

void FollowPass::record(VkCommandBuffer commands, const FollowBuffers& b, std::uint32_t elapsed_us) const {
  const shader::FollowPush push{elapsed_us, 0, 0, 0};
  pipeline_.dispatch(commands, {b.header, b.fingers, b.tracks}, push, 1);
}

}  // namespace palpa::touch
