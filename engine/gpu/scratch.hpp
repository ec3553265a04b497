// Memory that a pass works in from one of its dispatches to the next. The pass declares its pieces in one place;
// whoever records it makes the memory from that list and hands it over whole.
#pragma once

#include <span>
#include <vector>

#include "gpu/buffer.hpp"
#include "gpu/device.hpp"
#include "gpu/texel_view.hpp"

namespace palpa::gpu {

struct ScratchBuffer {
  const char* name = "";  ///< a string literal
  VkDeviceSize bytes = 0;
  VkFormat texels = VK_FORMAT_UNDEFINED;  ///< of its view, where a pass reads it as texels
};

/// The pieces of one pass, for one record of it at a time: one buffer, each piece at the alignment that any binding
/// needs. Contents are undefined until the pass writes them.
class Scratch {
 public:
  Scratch() = default;
  /// A piece of 0 bytes gets 4, others are rounded up to words. Before, between and after the pieces `margin` bytes at
  /// least lie idle: tests watch them.
  Scratch(const Device& device, std::vector<ScratchBuffer> pieces, const char* name, VkDeviceSize margin = 0);

  /// Piece number `piece` of the list, exactly: passes index with an enum of their own.
  BufferRef operator[](std::size_t piece) const { return refs_[piece]; }
  /// As made, the bytes being those of operator[].
  std::span<const ScratchBuffer> pieces() const { return pieces_; }
  BufferRef whole() const { return memory_.ref(); }

 private:
  std::vector<ScratchBuffer> pieces_;
  std::vector<BufferRef> refs_;
  Buffer memory_;
  std::vector<TexelView> texels_;
};

}  // namespace palpa::gpu
