#include "touch/follow/follow_pass.hpp"

#include "spirv/follow.comp.hpp"
#include "touch/types.hpp"

namespace palpa::touch {

static_assert(shader::follow_most_tracks >= 2 * max_fingers);

FollowPass::FollowPass(const gpu::Device& device)
    : pipeline_(device, "follow", spirv::follow_comp, sizeof(shader::FollowPush)) {}

void FollowPass::record(VkCommandBuffer commands, const FollowBindings& b, std::uint32_t elapsed_us,
                        const StageSetting& setting) const {
  const shader::FollowPush push{elapsed_us, setting.axes == Axes::steady ? 1U : 0U, setting.memory_us(), 0};
  pipeline_.dispatch(commands, spirv::follow_buffers(b), push, 1);
}

}  // namespace palpa::touch
