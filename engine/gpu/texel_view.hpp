// A buffer's contents as texels, read-only in shaders (a uniform texel buffer). For data that shaders read at scattered
// places: a software device fetches a texel of 16 bytes at once, but reads a storage buffer word by word and lane by
// lane, which takes several times as long.
#pragma once

#include <volk.h>

#include "gpu/buffer.hpp"
#include "gpu/device.hpp"
#include "gpu/handle.hpp"

namespace palpa::gpu {

class TexelView {
 public:
  TexelView() = default;
  /// Views all of `buffer`, which must outlive the view, plus 256 bytes behind it if that suits the device. `format` is
  /// one of the 32-bit formats that every device offers for texel buffers: R32_UINT, R32G32_UINT, R32G32B32A32_UINT or
  /// _SFLOAT. Throws failure if the buffer has more texels than the device can address.
  TexelView(const Device& device, const BufferRef& buffer, VkFormat format, const char* name);

  /// As a pass binds it.
  BufferRef ref() const;

 private:
  BufferRef buffer_;
  Handle<VkBufferView> view_;
};

}  // namespace palpa::gpu
