#include "gpu/barrier.hpp"

#include "gpu/watch.hpp"

namespace palpa::gpu {
namespace {

constexpr VkPipelineStageFlags2 compute = VK_PIPELINE_STAGE_2_COMPUTE_SHADER_BIT;
constexpr VkPipelineStageFlags2 indirect = VK_PIPELINE_STAGE_2_DRAW_INDIRECT_BIT;
constexpr VkPipelineStageFlags2 transfer = VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT;
constexpr VkAccessFlags2 shader_read = VK_ACCESS_2_SHADER_READ_BIT;
constexpr VkAccessFlags2 shader_write = VK_ACCESS_2_SHADER_WRITE_BIT;
constexpr VkAccessFlags2 transfer_any = VK_ACCESS_2_TRANSFER_READ_BIT | VK_ACCESS_2_TRANSFER_WRITE_BIT;

}  // namespace

void barrier(VkCommandBuffer commands, VkPipelineStageFlags2 from, VkAccessFlags2 wrote, VkPipelineStageFlags2 to,
             VkAccessFlags2 touches) {
  if (Watch* const sees = watch) sees->orders(commands, from, to);
  VkMemoryBarrier2 memory{VK_STRUCTURE_TYPE_MEMORY_BARRIER_2};
  memory.srcStageMask = from;
  memory.srcAccessMask = wrote;
  memory.dstStageMask = to;
  memory.dstAccessMask = touches;
  VkDependencyInfo info{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
  info.memoryBarrierCount = 1;
  info.pMemoryBarriers = &memory;
  vkCmdPipelineBarrier2(commands, &info);
}

void compute_to_compute(VkCommandBuffer commands) {
  barrier(commands, compute, shader_write, compute | indirect,
          shader_read | shader_write | VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT);
}

void transfer_to_use(VkCommandBuffer commands) {
  barrier(commands, transfer, VK_ACCESS_2_TRANSFER_WRITE_BIT,
          compute | indirect | transfer | VK_PIPELINE_STAGE_2_VERTEX_INPUT_BIT | VK_PIPELINE_STAGE_2_VERTEX_SHADER_BIT |
              VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT,
          shader_read | shader_write | transfer_any | VK_ACCESS_2_INDIRECT_COMMAND_READ_BIT |
              VK_ACCESS_2_VERTEX_ATTRIBUTE_READ_BIT | VK_ACCESS_2_INDEX_READ_BIT);
}

void writes_to_transfer(VkCommandBuffer commands) {
  barrier(commands, compute | indirect | transfer, shader_write | VK_ACCESS_2_TRANSFER_WRITE_BIT, transfer,
          transfer_any);
}

void writes_to_host(VkCommandBuffer commands) {
  barrier(commands, compute | transfer, shader_write | VK_ACCESS_2_TRANSFER_WRITE_BIT, VK_PIPELINE_STAGE_2_HOST_BIT,
          VK_ACCESS_2_HOST_READ_BIT);
}

}  // namespace palpa::gpu
