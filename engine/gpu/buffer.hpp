// Memory by purpose: kept on the device, written by the host, or read by the host.
#pragma once

#include <volk.h>

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <span>
#include <vector>

#include "gpu/device.hpp"
#include "gpu/handle.hpp"

namespace palpa::gpu {

/// A range of a buffer as a pass binds it.
struct BufferRef {
  VkBuffer buffer = VK_NULL_HANDLE;
  VkDeviceSize offset = 0;
  VkDeviceSize size = 0;
  VkBufferView texels = VK_NULL_HANDLE;  ///< for a binding that reads texels, see texel_view.hpp
};

/// Unused bytes behind the end of every buffer: room for a texel view that is extended.
inline constexpr VkDeviceSize texel_room = 256;

/// Device memory that only passes access. Contents are undefined until a pass or `vkCmdFillBuffer` writes them. Usable
/// as storage, texels, indirect, vertex, index and uniform buffer, and as source and destination of copies. A size of 0
/// allocates 4 bytes.
class Buffer {
 public:
  Buffer() = default;
  Buffer(const Device& device, VkDeviceSize size, const char* name);

  BufferRef ref() const { return {buffer_.get(), 0, size_}; }
  VkDeviceSize size() const { return size_; }

 private:
  friend class Upload;
  friend class Readback;
  Buffer(const Device& device, VkDeviceSize size, const char* name, VkMemoryPropertyFlags required,
         VkMemoryPropertyFlags preferred);
  std::byte* map(const Device& device) const;

  // Destroyed in reverse: the buffer before its memory. Each buffer has its own allocation: the engine keeps a few
  // dozen long-lived buffers, far below any driver's limit of allocations.
  Handle<VkDeviceMemory> memory_;
  Handle<VkBuffer> buffer_;
  VkDeviceSize size_ = 0;
};

/// The host writes `data()`, passes read `ref()`. With unified memory, both are the same bytes.
class Upload {
 public:
  Upload() = default;
  Upload(const Device& device, VkDeviceSize size, const char* name);

  std::byte* data() const { return mapped_; }
  template <typename T>
  std::span<T> as() const {
    return {reinterpret_cast<T*>(mapped_), static_cast<std::size_t>(ref().size / sizeof(T))};
  }
  BufferRef ref() const { return device_.size() ? device_.ref() : host_.ref(); }
  /// Writes these values from the beginning on. A buffer that is too small is replaced by a larger one. Returns their
  /// number of bytes.
  template <typename T>
  VkDeviceSize fill(const Device& device, const std::vector<T>& values, const char* name) {
    const VkDeviceSize bytes = values.size() * sizeof(T);
    if (data() == nullptr || ref().size < bytes)
      *this = Upload(device, std::max<VkDeviceSize>(bytes + bytes / 2, 4096), name);
    if (bytes != 0) std::memcpy(data(), values.data(), bytes);
    return bytes;
  }
  /// Call after the host has written: copies the first `bytes` and makes them visible to later compute, indirect,
  /// vertex and transfer reads. Records nothing if memory is unified, because a submit makes host writes visible.
  void record(VkCommandBuffer commands, VkDeviceSize bytes = VK_WHOLE_SIZE) const;

 private:
  Buffer host_;
  Buffer device_;
  std::byte* mapped_ = nullptr;
};

/// A buffer with these values, at least 4 bytes long. All that `commands` records afterwards can read them.
template <typename T>
Upload uploaded(const Device& device, VkCommandBuffer commands, std::span<const T> values, const char* name) {
  Upload buffer(device, values.size_bytes(), name);
  if (!values.empty()) std::memcpy(buffer.data(), values.data(), values.size_bytes());
  buffer.record(commands);
  return buffer;
}

/// Passes write `ref()`; the host reads `data()` after the submit that contains `record` has completed.
class Readback {
 public:
  Readback() = default;
  Readback(const Device& device, VkDeviceSize size, const char* name);

  const std::byte* data() const { return mapped_; }
  template <typename T>
  std::span<const T> as() const {
    return {reinterpret_cast<const T*>(mapped_), static_cast<std::size_t>(host_.size() / sizeof(T))};
  }
  BufferRef ref() const { return device_.size() ? device_.ref() : host_.ref(); }
  /// Call after the last compute or transfer write: makes the first `bytes` available to the host.
  void record(VkCommandBuffer commands, VkDeviceSize bytes = VK_WHOLE_SIZE) const;

 private:
  Buffer host_;
  Buffer device_;
  std::byte* mapped_ = nullptr;
};

}  // namespace palpa::gpu
