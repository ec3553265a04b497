#include "gpu/scan_pass.hpp"

#include "spirv/scan.comp.hpp"

namespace palpa::gpu {

ScanPass::ScanPass(const Device& device)
    : pipeline_(device, "scan", spirv::scan_comp, {shader::scan_buffers, sizeof(shader::ScanPush)}) {}

void ScanPass::record(VkCommandBuffer commands, BufferRef counts, BufferRef length, BufferRef total,
                      const Sizes& sizes) const {
  const bool dynamic = length.buffer != VK_NULL_HANDLE;
  const shader::ScanPush push{sizes.most_counts, dynamic ? sizes.items_per_count : 0u, sizes.most_total, 0,
                              sizes.groups};
  // A fixed length still needs something bound at its place.
  pipeline_.dispatch(commands, {counts, dynamic ? length : total, total}, push, 1);
}

}  // namespace palpa::gpu
