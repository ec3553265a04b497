#include "support/device.hpp"

#include <algorithm>
#include <memory>

#include "gpu/barrier.hpp"
#include "support/shader_modules.hpp"

namespace palpa::test {
namespace {
constexpr std::uint8_t guard_byte = 0xa5;

/// Copies all of a buffer from, and to, the host.
void fill(gpu::Device& device, gpu::BufferRef buffer, const std::vector<std::uint8_t>& bytes) {
  gpu::Upload upload(device, bytes.size(), "guarded upload");
  std::memcpy(upload.data(), bytes.data(), bytes.size());
  run_on_device([&](VkCommandBuffer commands) {
    upload.record(commands);
    const VkBufferCopy region{0, 0, bytes.size()};
    vkCmdCopyBuffer(commands, upload.ref().buffer, buffer.buffer, 1, &region);
    gpu::transfer_to_use(commands);
  });
}

std::vector<std::uint8_t> fetch(gpu::Device& device, gpu::BufferRef buffer) {
  gpu::Readback readback(device, buffer.size, "guarded readback");
  run_on_device([&](VkCommandBuffer commands) {
    gpu::writes_to_transfer(commands);
    const VkBufferCopy region{0, 0, buffer.size};
    vkCmdCopyBuffer(commands, buffer.buffer, readback.ref().buffer, 1, &region);
    readback.record(commands);
  });
  std::vector<std::uint8_t> bytes(buffer.size);
  std::memcpy(bytes.data(), readback.data(), bytes.size());
  return bytes;
}
}  // namespace

gpu::Device& test_device() {
  static gpu::Device device({.keep_pipelines = true});
  static const auto modules =
      device.validation() == gpu::Validation::gpu_assisted ? std::make_unique<ShaderModules>(device) : nullptr;
  return device;
}

void submit_and_wait(VkCommandBuffer commands) {
  gpu::Device& device = test_device();
  static gpu::Timeline timeline(device, "test");  // the layer keeps every timeline's last submit as well
  timeline.wait(timeline.submit(commands));
  if (device.validation() != gpu::Validation::off) vkQueueWaitIdle(device.queue());
}

void run_on_device(const std::function<void(VkCommandBuffer)>& record) {
  static const gpu::Recorder recorder(test_device(), "test");
  record(recorder.begin());
  submit_and_wait(recorder.end());
}

GuardedBuffer::GuardedBuffer(gpu::Device& device, std::size_t bytes, std::uint8_t fill)
    : device_(&device),
      bytes_(std::max<std::size_t>((bytes + 3) / 4 * 4, 4)),
      guard_(1024),
      total_(bytes_ + 2 * guard_),
      buffer_(device, total_, "guarded") {
  const std::vector<std::uint8_t> contents(bytes_, fill);
  write(contents.data(), contents.size());
}

void GuardedBuffer::write(const void* data, std::size_t bytes) {
  std::vector<std::uint8_t> all(total_, guard_byte);
  if (bytes > 0) std::memcpy(all.data() + guard_, data, std::min(bytes, bytes_));
  fill(*device_, buffer_.ref(), all);
}

void GuardedBuffer::read_bytes(void* out, std::size_t bytes) {
  const auto all = fetch(*device_, buffer_.ref());
  if (bytes > 0) std::memcpy(out, all.data() + guard_, bytes);
}

bool GuardedBuffer::intact() {
  const auto all = fetch(*device_, buffer_.ref());
  const auto good = [](std::uint8_t byte) { return byte == guard_byte; };
  return std::all_of(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(guard_), good) &&
         std::all_of(all.end() - static_cast<std::ptrdiff_t>(guard_), all.end(), good);
}

GuardedScratch::GuardedScratch(gpu::Device& device, std::vector<gpu::ScratchBuffer> pieces, std::uint8_t rubbish)
    : device_(&device),
      scratch_(device, std::move(pieces), "guarded scratch", 1024),
      made_(scratch_.whole().size, guard_byte) {
  for (std::size_t piece = 0; piece < scratch_.pieces().size(); ++piece)
    std::memset(made_.data() + scratch_[piece].offset, rubbish, scratch_[piece].size);
  fill(*device_, scratch_.whole(), made_);
}

bool GuardedScratch::intact() const {
  std::vector<std::uint8_t> now = fetch(*device_, scratch_.whole());
  for (std::size_t piece = 0; piece < scratch_.pieces().size(); ++piece) {
    const auto at = static_cast<std::ptrdiff_t>(scratch_[piece].offset);
    std::copy_n(made_.begin() + at, scratch_[piece].size, now.begin() + at);
  }
  return now == made_;
}

}  // namespace palpa::test
