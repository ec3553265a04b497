// One Vulkan device per test process, and buffers whose edges are watched.
#pragma once

#include <cstdint>
#include <cstring>
#include <functional>
#include <span>
#include <vector>

#include "gpu/buffer.hpp"
#include "gpu/commands.hpp"
#include "gpu/device.hpp"
#include "gpu/scratch.hpp"

namespace palpa::test {

/// The device that the environment selects (PALPA_VALIDATION, PALPA_FORCE_STAGING, VK_DRIVER_FILES, ...). It keeps its
/// pipelines, which take longer to make than most cases do. A case that counts pipelines needs its own device.
gpu::Device& test_device();

/// Submits to test_device() and waits. It also waits in a way that the validation layer recognizes. Otherwise the layer
/// keeps its data on every submit and compares each with all earlier ones: it ignores timelines on which the host
/// waits.
void submit_and_wait(VkCommandBuffer commands);

/// Records `record`, submits and waits.
void run_on_device(const std::function<void(VkCommandBuffer)>& record);

/// A device buffer between two runs of guard words. A pass binds `ref()`; `intact()` says whether it stayed inside.
class GuardedBuffer {
 public:
  /// Contents start as `fill` bytes; `bytes` is rounded up to the storage offset alignment with further guard words.
  GuardedBuffer(gpu::Device& device, std::size_t bytes, std::uint8_t fill = 0xcd);
  template <typename T>
  static GuardedBuffer of(gpu::Device& device, std::span<const T> values) {
    GuardedBuffer buffer(device, values.size_bytes());
    buffer.write(values.data(), values.size_bytes());
    return buffer;
  }

  gpu::BufferRef ref() const { return {buffer_.ref().buffer, guard_, bytes_}; }
  void write(const void* data, std::size_t bytes);
  /// Copies the contents back to the host.
  template <typename T>
  std::vector<T> read() {
    std::vector<T> values(bytes_ / sizeof(T));
    read_bytes(values.data(), values.size() * sizeof(T));
    return values;
  }
  /// Whether every guard word before and after the buffer still has its pattern.
  bool intact();

 private:
  void read_bytes(void* out, std::size_t bytes);

  gpu::Device* device_;
  std::size_t bytes_, guard_, total_;
  gpu::Buffer buffer_;
};

/// A pass's scratch as the pass declares it; each piece lies between guard words and is filled with `fill` bytes.
class GuardedScratch {
 public:
  GuardedScratch(gpu::Device& device, std::vector<gpu::ScratchBuffer> pieces, std::uint8_t fill = 0xcd);

  operator const gpu::Scratch&() const { return scratch_; }
  /// Whether every byte outside the pieces still has its pattern.
  bool intact() const;

 private:
  gpu::Device* device_;
  gpu::Scratch scratch_;
  std::vector<std::uint8_t> made_;
};

}  // namespace palpa::test
