#include "touch/split/split_pass.hpp"

#include <cstddef>

#include "gpu/barrier.hpp"
#include "shaders/touch/fingers/fingers.h"
#include "spirv/split_assign.comp.hpp"
#include "spirv/split_list.comp.hpp"
#include "spirv/split_look.comp.hpp"
#include "spirv/split_parts.comp.hpp"
#include "spirv/split_sample.comp.hpp"
#include "touch/split/split_twin.hpp"

namespace palpa::touch {

static_assert(shader::split_group == shader::bridge_samples && shader::split_group == max_fingers);
static_assert(shader::split_numbers >= shader::bridge_samples);

namespace {
/// The buffers that the kernels bind, by name: those of the caller and the scratch.
struct Buffers : SplitBindings {
  gpu::BufferRef samples = {}, states = {}, shown = {}, labels = {};
};
}  // namespace

SplitPass::SplitPass(const gpu::Device& device)
    : sample_(device, "split sample", spirv::split_sample_comp, sizeof(shader::SplitPush)),
      look_(device, "split look", spirv::split_look_comp, sizeof(shader::SplitPush)),
      parts_(device, "split parts", spirv::split_parts_comp, sizeof(shader::SplitPush)),
      assign_(device, "split assign", spirv::split_assign_comp, sizeof(shader::SplitPush)),
      list_(device, "split list", spirv::split_list_comp, sizeof(shader::SplitPush)) {}

std::vector<gpu::ScratchBuffer> SplitPass::scratch() {
  constexpr std::uint64_t fingers = max_fingers;
  std::vector<gpu::ScratchBuffer> list(scratch_count);
  list[samples] = {"split samples", fingers * shader::bridge_samples * sizeof(shader::BridgeSample)};
  list[states] = {"split states", fingers * sizeof(shader::SplitState)};
  list[evidence] = {"split evidence", fingers * shader::bridge_samples * sizeof(shader::SplitEvidence)};
  list[labels] = {"split labels", fingers * shader::bridge_samples * sizeof(std::uint32_t)};
  return list;
}

void SplitPass::record(VkCommandBuffer commands, const SplitBindings& b, const gpu::Scratch& s, const Room& room,
                       const Parameters& parameters, const KnownFrame& known) const {
  const auto cameras = static_cast<std::uint32_t>(b.cameras.size / sizeof(shader::BridgeCamera));
  const shader::SplitPush push{
      room.contacts, cameras, splitting_width(parameters), parameters.min_points, known.elapsed_us, known.rules, 0, 0};
  const auto groups = [&](VkDeviceSize at) { return gpu::groups_in(b.header, at); };
  Buffers buffers{b};
  buffers.samples = s[samples];
  buffers.states = s[states];
  buffers.shown = s[evidence];
  buffers.labels = s[labels];
  sample_.dispatch_indirect(commands, spirv::split_sample_buffers(buffers), push,
                            groups(offsetof(shader::TouchHeader, fingers)));
  gpu::compute_to_compute(commands);
  look_.dispatch_indirect(commands, spirv::split_look_buffers(buffers), push,
                          groups(offsetof(shader::TouchHeader, look_x)));
  gpu::compute_to_compute(commands);
  parts_.dispatch_indirect(commands, spirv::split_parts_buffers(buffers), push,
                           groups(offsetof(shader::TouchHeader, parts_x)));
  gpu::compute_to_compute(commands);
  assign_.dispatch_indirect(commands, spirv::split_assign_buffers(buffers), push,
                            groups(offsetof(shader::TouchHeader, assign_x)));
  gpu::compute_to_compute(commands);
  list_.dispatch_indirect(commands, spirv::split_list_buffers(buffers), push,
                          groups(offsetof(shader::TouchHeader, list_x)));
}

}  // namespace palpa::touch
