#include "viewer/render/offscreen.hpp"

#include <cstring>

#include "gpu/barrier.hpp"

namespace palpa::viewer {
namespace {

constexpr VkFormat format = VK_FORMAT_R8G8B8A8_UNORM;

/// The image is drawn to, and the readback buffer is written, only after the last draw's copy between them. The host
/// has already waited for that copy. This barrier tells the device the same.
void after_last_copy(VkCommandBuffer commands) {
  gpu::barrier(commands, VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT | VK_PIPELINE_STAGE_2_HOST_BIT,
               VK_ACCESS_2_TRANSFER_WRITE_BIT,
               VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT | VK_PIPELINE_STAGE_2_COLOR_ATTACHMENT_OUTPUT_BIT,
               VK_ACCESS_2_TRANSFER_WRITE_BIT);
}

}  // namespace

Offscreen::Offscreen(const gpu::Device& device, std::uint32_t width, std::uint32_t height, double ratio,
                     Fineness fineness)
    : renderer_(device, format),
      canvas_(renderer_.make_canvas({width, height}, fineness)),
      image_(device,
             {{width, height},
              format,
              VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT,
              VK_SAMPLE_COUNT_1_BIT},
             "picture"),
      readback_(device, VkDeviceSize{4} * width * height, "picture readback"),
      recorder_(device, "picture"),
      timeline_(device, "picture"),
      ratio_(ratio) {}

void Offscreen::draw(DrawnPicture& drawn, const Viewpoint& viewpoint) {
  const View view = whole(viewpoint, width(), height());
  draw(drawn, std::span(&view, 1));
}

void Offscreen::draw(DrawnPicture& drawn, std::span<const View> views, const Sheet* sheet,
                     const std::function<void()>& pause) {
  NextStep next;
  if (pause) {
    next = [&] {
      pause();
      timeline_.wait(timeline_.submit(recorder_.end()));
      return recorder_.begin();
    };
  }
  VkCommandBuffer commands = recorder_.begin();
  after_last_copy(commands);
  commands = renderer_.record(commands, drawn, views, canvas_, {image_.get(), image_.view()}, ratio_, sheet, next);
  gpu::transition(commands, image_.get(), format, gpu::image_use::colour_target, gpu::image_use::copied_from);
  VkBufferImageCopy region{};
  region.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
  region.imageExtent = {width(), height(), 1};
  vkCmdCopyImageToBuffer(commands, image_.get(), VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, readback_.ref().buffer, 1,
                         &region);
  readback_.record(commands);
  if (pause) pause();
  timeline_.wait(timeline_.submit(recorder_.end()));
  drawn_ = true;
}

Pixels Offscreen::pixels() const {
  Pixels out{width(), height(), std::vector<std::uint8_t>(std::size_t{4} * width() * height())};
  if (drawn_) std::memcpy(out.rgba.data(), readback_.data(), out.rgba.size());
  return out;
}

}  // namespace palpa::viewer
