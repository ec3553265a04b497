#include "touch/bridge/bridge_pass.hpp"

#include <cstddef>

#include "gpu/barrier.hpp"
#include "shaders/touch/bridge/bridge.h"
#include "shaders/touch/fingers/fingers.h"
#include "spirv/bridge_join.comp.hpp"
#include "spirv/bridge_pairs.comp.hpp"
#include "spirv/bridge_relabel.comp.hpp"
#include "spirv/bridge_sample.comp.hpp"

namespace palpa::touch {

static_assert(shader::bridge_fingers == max_fingers);
static_assert(shader::bridge_samples == shader::bridge_group && shader::bridge_fingers == shader::bridge_group);
static_assert(shader::bridge_samples == 1U << (32 - shader::bridge_sample_shift));
static_assert(shader::bridge_hash * shader::bridge_unhash == 1U);

namespace {
/// The buffers that the kernels bind, by name: those of the caller and the scratch.
struct Buffers : BridgeBindings {
  gpu::BufferRef samples = {}, patches = {}, pairs = {};
};
}  // namespace

BridgePass::BridgePass(const gpu::Device& device)
    : sample_(device, "bridge sample", spirv::bridge_sample_comp, sizeof(shader::BridgePush)),
      pairs_(device, "bridge pairs", spirv::bridge_pairs_comp, sizeof(shader::BridgePush)),
      join_(device, "bridge join", spirv::bridge_join_comp, sizeof(shader::BridgePush)),
      relabel_(device, "bridge relabel", spirv::bridge_relabel_comp, sizeof(shader::BridgePush)) {}

std::vector<gpu::ScratchBuffer> BridgePass::scratch() {
  constexpr std::uint64_t fingers = max_fingers;
  std::vector<gpu::ScratchBuffer> list(scratch_count);
  list[samples] = {"bridge samples", fingers * shader::bridge_samples * sizeof(shader::BridgeSample)};
  list[patches] = {"bridge patches", fingers * sizeof(shader::BridgePatch)};
  list[pairs] = {"bridge pairs", fingers * fingers * sizeof(shader::BridgePair)};
  return list;
}

void BridgePass::record(VkCommandBuffer commands, const BridgeBindings& b, const gpu::Scratch& s, const Room& room,
                        const Parameters& parameters, const KnownFrame& known) const {
  const auto cameras = static_cast<std::uint32_t>(b.cameras.size / sizeof(shader::BridgeCamera));
  const shader::BridgePush push{
      room.contacts, cameras, static_cast<float>(parameters.finger_width_m), known.elapsed_us, known.rules, 0, 0, 0};
  const auto groups = [&](VkDeviceSize at) { return gpu::groups_in(b.header, at); };
  constexpr VkDeviceSize per_patch = offsetof(shader::TouchHeader, patches_x);
  Buffers buffers{b};
  buffers.samples = s[samples];
  buffers.patches = s[patches];
  buffers.pairs = s[pairs];
  sample_.dispatch_indirect(commands, spirv::bridge_sample_buffers(buffers), push, groups(per_patch));
  gpu::compute_to_compute(commands);
  pairs_.dispatch_indirect(commands, spirv::bridge_pairs_buffers(buffers), push, groups(per_patch));
  gpu::compute_to_compute(commands);
  join_.dispatch_indirect(commands, spirv::bridge_join_buffers(buffers), push,
                          groups(offsetof(shader::TouchHeader, join_x)));
  gpu::compute_to_compute(commands);
  relabel_.dispatch_indirect(commands, spirv::bridge_relabel_buffers(buffers), push,
                             groups(offsetof(shader::TouchHeader, relabel_x)));
}

}  // namespace palpa::touch
