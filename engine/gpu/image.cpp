#include "gpu/image.hpp"

#include <fmt/core.h>

#include "base/error.hpp"
#include "gpu/allocation.hpp"
#include "gpu/check.hpp"

namespace palpa::gpu {

VkImageAspectFlags aspect_of(VkFormat format) {
  switch (format) {
    case VK_FORMAT_D16_UNORM:
    case VK_FORMAT_X8_D24_UNORM_PACK32:
    case VK_FORMAT_D32_SFLOAT:
      return VK_IMAGE_ASPECT_DEPTH_BIT;
    default:
      return VK_IMAGE_ASPECT_COLOR_BIT;
  }
}

Image::Image(const Device& device, const Options& options, const char* name) : options_(options) {
  const std::uint32_t most = device.limits().maxImageDimension2D;
  const auto [width, height] = options.extent;
  if (width == 0 || height == 0 || width > most || height > most) {
    throw failure(fmt::format("{}: cannot make an image of {}x{} pixels: each side must be 1 to {}",
                              device.description().name, width, height, most));
  }
  VkImageCreateInfo info{VK_STRUCTURE_TYPE_IMAGE_CREATE_INFO};
  info.imageType = VK_IMAGE_TYPE_2D;
  info.format = options.format;
  info.extent = {width, height, 1};
  info.mipLevels = 1;
  info.arrayLayers = 1;
  info.samples = options.samples;
  info.tiling = VK_IMAGE_TILING_OPTIMAL;
  info.usage = options.usage;
  VkImage image = VK_NULL_HANDLE;
  PALPA_VK(vkCreateImage(device.get(), &info, nullptr, &image));
  image_ = Handle<VkImage>(device.get(), image, vkDestroyImage);
  device.name(VK_OBJECT_TYPE_IMAGE, reinterpret_cast<std::uint64_t>(image), name);

  VkMemoryRequirements needs;
  vkGetImageMemoryRequirements(device.get(), image, &needs);
  const bool transient = options.usage & VK_IMAGE_USAGE_TRANSIENT_ATTACHMENT_BIT;
  const VkMemoryPropertyFlags wanted =
      VK_MEMORY_PROPERTY_DEVICE_LOCAL_BIT |
      (transient ? static_cast<VkMemoryPropertyFlags>(VK_MEMORY_PROPERTY_LAZILY_ALLOCATED_BIT) : 0);
  memory_ = allocate_memory(device, needs.size, device.memory_type(needs.memoryTypeBits, 0, wanted));
  PALPA_VK(vkBindImageMemory(device.get(), image, memory_.get(), 0));

  VkImageViewCreateInfo view_info{VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO};
  view_info.image = image;
  view_info.viewType = VK_IMAGE_VIEW_TYPE_2D;
  view_info.format = options.format;
  view_info.subresourceRange = {aspect_of(options.format), 0, 1, 0, 1};
  VkImageView view = VK_NULL_HANDLE;
  PALPA_VK(vkCreateImageView(device.get(), &view_info, nullptr, &view));
  view_ = Handle<VkImageView>(device.get(), view, vkDestroyImageView);
}

void transition(VkCommandBuffer commands, VkImage image, VkFormat format, const ImageUse& from, const ImageUse& to) {
  VkImageMemoryBarrier2 barrier{VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2};
  barrier.srcStageMask = from.stages;
  barrier.srcAccessMask = from.access;
  barrier.dstStageMask = to.stages;
  barrier.dstAccessMask = to.access;
  barrier.oldLayout = from.layout;
  barrier.newLayout = to.layout;
  barrier.srcQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
  barrier.image = image;
  barrier.subresourceRange = {aspect_of(format), 0, 1, 0, 1};
  VkDependencyInfo info{VK_STRUCTURE_TYPE_DEPENDENCY_INFO};
  info.imageMemoryBarrierCount = 1;
  info.pImageMemoryBarriers = &barrier;
  vkCmdPipelineBarrier2(commands, &info);
}

}  // namespace palpa::gpu
