// Images that passes render into, and the transitions between their uses.
#pragma once

#include <volk.h>

#include "gpu/device.hpp"
#include "gpu/handle.hpp"

namespace palpa::gpu {

/// A 2-D image with one mip level, one layer and its own memory and view. Contents are undefined initially.
class Image {
 public:
  struct Options {
    VkExtent2D extent{};
    VkFormat format = VK_FORMAT_UNDEFINED;
    VkImageUsageFlags usage = 0;
    VkSampleCountFlagBits samples = VK_SAMPLE_COUNT_1_BIT;
  };

  Image() = default;
  /// Throws failure() if the device cannot make an image of that size. With VK_IMAGE_USAGE_TRANSIENT_ATTACHMENT_BIT,
  /// memory is lazily allocated if the device offers that.
  Image(const Device& device, const Options& options, const char* name);

  VkImage get() const { return image_.get(); }
  VkImageView view() const { return view_.get(); }
  VkExtent2D extent() const { return options_.extent; }
  VkFormat format() const { return options_.format; }

 private:
  // Destroyed in reverse: the view before the image before its memory.
  Handle<VkDeviceMemory> memory_;
  Handle<VkImage> image_;
  Handle<VkImageView> view_;
  Options options_;
};

/// VK_IMAGE_ASPECT_DEPTH_BIT for the depth formats that palpa uses, else colour.
VkImageAspectFlags aspect_of(VkFormat format);

/// One use of an image: the layout it must have, and which stages access it.
struct ImageUse {
  VkImageLayout layout;
  VkPipelineStageFlags2 stages;
  VkAccessFlags2 access;
};
namespace image_use {
/// Before drawing: the old contents may be discarded, but earlier writes to the image must have ended.
inline constexpr ImageUse discard_colour{VK_IMAGE_LAYOUT_UNDEFINED, VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT,
                                         VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT};
inline constexpr ImageUse discard_depth{VK_IMAGE_LAYOUT_UNDEFINED, VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT,
                                        VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT};
inline constexpr ImageUse colour_target{VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL,
                                        VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT,
                                        VK_ACCESS_2_COLOR_ATTACHMENT_READ_BIT | VK_ACCESS_2_COLOR_ATTACHMENT_WRITE_BIT};
inline constexpr ImageUse depth_target{
    VK_IMAGE_LAYOUT_DEPTH_ATTACHMENT_OPTIMAL,
    VK_PIPELINE_STAGE_2_EARLY_FRAGMENT_TESTS_BIT | VK_PIPELINE_STAGE_2_LATE_FRAGMENT_TESTS_BIT,
    VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_READ_BIT | VK_ACCESS_2_DEPTH_STENCIL_ATTACHMENT_WRITE_BIT};
inline constexpr ImageUse copied_from{VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT,
                                      VK_ACCESS_2_TRANSFER_READ_BIT};
/// Before a copy to the image: like discard_colour and discard_depth.
inline constexpr ImageUse discard_copied{VK_IMAGE_LAYOUT_UNDEFINED, VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT,
                                         VK_ACCESS_2_TRANSFER_WRITE_BIT};
inline constexpr ImageUse copied_to{VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT,
                                    VK_ACCESS_2_TRANSFER_WRITE_BIT};
/// Presentation waits on a semaphore; the stage only ties the transition to the semaphore's signal.
inline constexpr ImageUse presented{VK_IMAGE_LAYOUT_PRESENT_SRC_KHR, VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
                                    VK_ACCESS_2_NONE};
}  // namespace image_use

/// Records the transition of `image` from one use to the next.
void transition(VkCommandBuffer commands, VkImage image, VkFormat format, const ImageUse& from, const ImageUse& to);

}  // namespace palpa::gpu
