#include "touch/known/known_pass.hpp"

#include <cstddef>

#include "gpu/barrier.hpp"
#include "shaders/touch/bridge/bridge.h"
#include "shaders/touch/fingers/fingers.h"
#include "spirv/known_admit.comp.hpp"
#include "spirv/known_claim.comp.hpp"
#include "spirv/known_keep.comp.hpp"

namespace palpa::touch {

static_assert(shader::known_fingers == max_fingers && shader::known_samples == shader::bridge_samples);

namespace {

/// The buffers that the kernels bind, by name: those of the caller and the scratch.
struct ClaimBuffers : KnownBindings {
  gpu::BufferRef claims = {};
};

shader::KnownPush push_of(const KnownBindings& b, const Room& room, const Parameters& parameters,
                          const KnownFrame& frame) {
  return {room.contacts,
          static_cast<std::uint32_t>(b.cameras.size / sizeof(shader::BridgeCamera)),
          static_cast<float>(parameters.finger_width_m),
          parameters.min_points,
          frame.elapsed_us,
          frame.rules,
          0,
          0};
}

gpu::BufferRef per_finger(const KnownBindings& b) {
  return gpu::groups_in(b.header, offsetof(shader::TouchHeader, fingers));
}

}  // namespace

KnownPass::KnownPass(const gpu::Device& device)
    : claim_(device, "known claim", spirv::known_claim_comp, sizeof(shader::KnownPush)),
      admit_(device, "known admit", spirv::known_admit_comp, sizeof(shader::KnownPush)),
      keep_(device, "known keep", spirv::known_keep_comp, sizeof(shader::KnownPush)) {}

std::vector<gpu::ScratchBuffer> KnownPass::scratch() {
  std::vector<gpu::ScratchBuffer> list(scratch_count);
  list[claims] = {"finger claims", std::uint64_t{max_fingers} * sizeof(shader::Claim)};
  return list;
}

void KnownPass::admit(VkCommandBuffer commands, const KnownBindings& b, const gpu::Scratch& s, const Room& room,
                      const Parameters& parameters, const KnownFrame& frame) const {
  const shader::KnownPush push = push_of(b, room, parameters, frame);
  ClaimBuffers buffers{b};
  buffers.claims = s[claims];
  claim_.dispatch_indirect(commands, spirv::known_claim_buffers(buffers), push, per_finger(b));
  gpu::compute_to_compute(commands);
  admit_.dispatch(commands, spirv::known_admit_buffers(buffers), push, 1);
}

void KnownPass::keep(VkCommandBuffer commands, const KnownBindings& b, const gpu::Scratch& s, const Room& room,
                     const Parameters& parameters, const KnownFrame& frame) const {
  ClaimBuffers buffers{b};
  buffers.claims = s[claims];
  keep_.dispatch_indirect(commands, spirv::known_keep_buffers(buffers), push_of(b, room, parameters, frame),
                          per_finger(b));
}

}  // namespace palpa::touch
