#include "gpu/texel_view.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "base/error.hpp"
#include "gpu/check.hpp"

namespace palpa::gpu {
namespace {

VkDeviceSize texel_bytes(VkFormat format) {
  return format == VK_FORMAT_R32_UINT ? 4 : format == VK_FORMAT_R32G32_UINT ? 8 : 16;
}

/// Mesa's software device distinguishes views in which bits 8 to 15 of the size in bytes are all 0, and compiles a
/// kernel again for each mixture of such and other views. A scene or an array of another size would cost seconds.
VkDeviceSize of_one_kind(VkDeviceSize bytes) {
  return (bytes >> 8 & 0xff) == 0 ? bytes + 0x100 : bytes;
}
static_assert(texel_room >= 0x100);

}  // namespace

TexelView::TexelView(const Device& device, const BufferRef& buffer, VkFormat format, const char* name)
    : buffer_(buffer) {
  const VkDeviceSize texels = buffer.size / texel_bytes(format);
  if (texels > device.limits().maxTexelBufferElements) {
    throw failure(fmt::format("{}: {} texels, but {} addresses at most {}", name, texels, device.description().name,
                              device.limits().maxTexelBufferElements));
  }
  VkBufferViewCreateInfo info{VK_STRUCTURE_TYPE_BUFFER_VIEW_CREATE_INFO};
  info.buffer = buffer.buffer;
  info.format = format;
  info.offset = buffer.offset;
  info.range =
      std::min(of_one_kind(texels * texel_bytes(format)), device.limits().maxTexelBufferElements * texel_bytes(format));
  VkBufferView view = VK_NULL_HANDLE;
  PALPA_VK(vkCreateBufferView(device.get(), &info, nullptr, &view));
  view_ = Handle<VkBufferView>(device.get(), view, vkDestroyBufferView);
  device.name(VK_OBJECT_TYPE_BUFFER_VIEW, reinterpret_cast<std::uint64_t>(view), name);
}

BufferRef TexelView::ref() const {
  BufferRef ref = buffer_;
  ref.texels = view_.get();
  return ref;
}

}  // namespace palpa::gpu
