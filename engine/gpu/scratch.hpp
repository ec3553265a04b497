// Working memory that a pass keeps from one of its dispatches to the next. The pass declares its pieces in one place;
// the code that records it allocates them from that list and passes them on as one object.
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
  VkFormat texels = VK_FORMAT_UNDEFINED;  ///< format of its view, if a pass reads it as texels
};

/// The pieces of one pass, for one recording of it at a time: one buffer, each piece aligned for any binding. Contents
/// are undefined until the pass writes them.
class Scratch {
 public:
  Scratch() = default;
  /// A piece of 0 bytes gets 4; others are rounded up to words. At least `margin` unused bytes lie before, between and
  /// after the pieces: tests check that they do not change.
  Scratch(const Device& device, std::vector<ScratchBuffer> pieces, const char* name, VkDeviceSize margin = 0);

  /// Exactly piece number `piece` of the list: passes index with their own enum.
  BufferRef operator[](std::size_t piece) const { return refs_[piece]; }
  /// As allocated; the bytes are those of operator[].
  std::span<const ScratchBuffer> pieces() const { return pieces_; }
  BufferRef whole() const { return memory_.ref(); }

 private:
  std::vector<ScratchBuffer> pieces_;
  std::vector<BufferRef> refs_;
  Buffer memory_;
  std::vector<TexelView> texels_;
};

}  // namespace palpa::gpu
