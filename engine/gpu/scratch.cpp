#include "gpu/scratch.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "base/error.hpp"

namespace palpa::gpu {
namespace {

VkDeviceSize rounded_up(VkDeviceSize bytes, VkDeviceSize step) {
  return (bytes + step - 1) / step * step;
}

}  // namespace

Scratch::Scratch(const Device& device, std::vector<ScratchBuffer> pieces, const char* name, VkDeviceSize margin)
    : pieces_(std::move(pieces)) {
  const VkPhysicalDeviceLimits& limits = device.limits();
  const VkDeviceSize step =
      std::max<VkDeviceSize>({16, limits.minStorageBufferOffsetAlignment, limits.minTexelBufferOffsetAlignment});
  VkDeviceSize end = 0;
  for (ScratchBuffer& piece : pieces_) {
    piece.bytes = std::max<VkDeviceSize>(rounded_up(piece.bytes, 4), 4);
    if (piece.bytes > limits.maxStorageBufferRange) {
      throw failure(fmt::format("{}: {} bytes of {} exceed the {} that {} binds at once", name, piece.bytes, piece.name,
                                limits.maxStorageBufferRange, device.description().name));
    }
    const VkDeviceSize begin = rounded_up(end + margin, step);
    refs_.push_back({VK_NULL_HANDLE, begin, piece.bytes});
    end = begin + piece.bytes;
  }
  memory_ = Buffer(device, end + margin, name);
  for (std::size_t piece = 0; piece < pieces_.size(); ++piece) {
    refs_[piece].buffer = memory_.ref().buffer;
    if (pieces_[piece].texels == VK_FORMAT_UNDEFINED) continue;
    texels_.emplace_back(device, refs_[piece], pieces_[piece].texels, pieces_[piece].name);
    refs_[piece] = texels_.back().ref();
  }
}

}  // namespace palpa::gpu
