#include "gpu/scan_pass.hpp"

#include "spirv/scan.comp.hpp"

namespace palpa::gpu {

ScanPass::ScanPass(const Device& device) : pipeline_(device, "scan", spirv::scan_comp, sizeof(shader::ScanPush)) {}

void ScanPass::record(VkCommandBuffer commands, ScanBindings b, const Sizes& sizes) const {
  const bool dynamic = b.length.buffer != VK_NULL_HANDLE;
  const shader::ScanPush push{sizes.most_counts, dynamic ? sizes.items_per_count : 0u, sizes.most_total, 0,
                              sizes.groups};
  if (!dynamic) b.length = b.total;  // something must be bound there
  pipeline_.dispatch(commands, spirv::scan_buffers(b), push, 1);
}

}  // namespace palpa::gpu
