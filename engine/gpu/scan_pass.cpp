#include "gpu/scan_pass.hpp"

#include "spirv/scan.comp.hpp"

namespace palpa::gpu {

ScanPass::ScanPass(const Device& device) : pipeline_(device, "scan", spirv::scan_comp, sizeof(shader::ScanPush)) {}

void ScanPass::record(VkCommandBuffer commands, const ScanBindings& bindings, const Sizes& sizes) const {
  const shader::ScanPush push{sizes.counts, sizes.most_total, sizes.groups};
  pipeline_.dispatch(commands, spirv::scan_buffers(bindings), push, 1);
}

}  // namespace palpa::gpu
