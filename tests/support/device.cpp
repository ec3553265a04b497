#include "support/device.hpp"

#include <algorithm>
#include <memory>

#include "gpu/barrier.hpp"
#include "support/shader_modules.hpp"

namespace palpa::test {
namespace {
constexpr std::uint8_t guard_byte = 0xa5;
}

gpu::Device& test_device() {
  static gpu::Device device;
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
  gpu::Upload upload(*device_, total_, "guarded upload");
  std::memset(upload.data(), guard_byte, total_);
  std::memcpy(upload.data() + guard_, data, std::min(bytes, bytes_));
  run_on_device([&](VkCommandBuffer commands) {
    upload.record(commands);
    const VkBufferCopy region{0, 0, total_};
    vkCmdCopyBuffer(commands, upload.ref().buffer, buffer_.ref().buffer, 1, &region);
    gpu::transfer_to_use(commands);
  });
}

std::vector<std::uint8_t> GuardedBuffer::fetch() {
  gpu::Readback readback(*device_, total_, "guarded readback");
  run_on_device([&](VkCommandBuffer commands) {
    gpu::writes_to_transfer(commands);
    const VkBufferCopy region{0, 0, total_};
    vkCmdCopyBuffer(commands, buffer_.ref().buffer, readback.ref().buffer, 1, &region);
    readback.record(commands);
  });
  std::vector<std::uint8_t> bytes(total_);
  std::memcpy(bytes.data(), readback.data(), total_);
  return bytes;
}

void GuardedBuffer::read_bytes(void* out, std::size_t bytes) {
  const auto all = fetch();
  std::memcpy(out, all.data() + guard_, bytes);
}

bool GuardedBuffer::intact() {
  const auto all = fetch();
  const auto good = [](std::uint8_t byte) { return byte == guard_byte; };
  return std::all_of(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(guard_), good) &&
         std::all_of(all.end() - static_cast<std::ptrdiff_t>(guard_), all.end(), good);
}

}  // namespace palpa::test
