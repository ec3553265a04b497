#include "gpu/commands.hpp"

#include <exception>

#include "base/error.hpp"
#include "gpu/check.hpp"
#include "gpu/patience.hpp"
#include "gpu/watch.hpp"

namespace palpa::gpu {

Recorder::Recorder(const Device& device, const char* name) : device_(&device) {
  VkCommandPoolCreateInfo info{VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO};
  info.flags = VK_COMMAND_POOL_CREATE_TRANSIENT_BIT;
  info.queueFamilyIndex = device.queue_family();
  VkCommandPool pool = VK_NULL_HANDLE;
  PALPA_VK(vkCreateCommandPool(device.get(), &info, nullptr, &pool));
  pool_ = Handle<VkCommandPool>(device.get(), pool, vkDestroyCommandPool);
  VkCommandBufferAllocateInfo allocate{VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO};
  allocate.commandPool = pool;
  allocate.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
  allocate.commandBufferCount = 1;
  PALPA_VK(vkAllocateCommandBuffers(device.get(), &allocate, &commands_));
  device.name(VK_OBJECT_TYPE_COMMAND_BUFFER, reinterpret_cast<std::uint64_t>(commands_), name);
}

VkCommandBuffer Recorder::begin() const {
  PALPA_VK(vkResetCommandPool(device_->get(), pool_.get(), 0));
  VkCommandBufferBeginInfo info{VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO};
  info.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
  PALPA_VK(vkBeginCommandBuffer(commands_, &info));
  if (Watch* const sees = watch) sees->begins(commands_);
  return commands_;
}

VkCommandBuffer Recorder::end() const {
  PALPA_VK(vkEndCommandBuffer(commands_));
  return commands_;
}

Timeline::Timeline(const Device& device, const char* name) : device_(&device) {
  VkSemaphoreTypeCreateInfo type{VK_STRUCTURE_TYPE_SEMAPHORE_TYPE_CREATE_INFO};
  type.semaphoreType = VK_SEMAPHORE_TYPE_TIMELINE;
  VkSemaphoreCreateInfo info{VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO, &type};
  VkSemaphore semaphore = VK_NULL_HANDLE;
  PALPA_VK(vkCreateSemaphore(device.get(), &info, nullptr, &semaphore));
  semaphore_ = Handle<VkSemaphore>(device.get(), semaphore, vkDestroySemaphore);
  device.name(VK_OBJECT_TYPE_SEMAPHORE, reinterpret_cast<std::uint64_t>(semaphore), name);
}

Timeline::~Timeline() {
  if (last_ == 0 || device_->lost()) return;
  try {
    wait(last_, 10.0);
  } catch (const std::exception&) {
    // A lost device finishes nothing, and a destructor cannot report it.
  }
}

std::uint64_t Timeline::submit(VkCommandBuffer commands) {
  const std::uint64_t value = last_ + 1;
  const VkSemaphore semaphore = semaphore_.get();
  VkTimelineSemaphoreSubmitInfo timeline{VK_STRUCTURE_TYPE_TIMELINE_SEMAPHORE_SUBMIT_INFO};
  timeline.signalSemaphoreValueCount = 1;
  timeline.pSignalSemaphoreValues = &value;
  VkSubmitInfo info{VK_STRUCTURE_TYPE_SUBMIT_INFO, &timeline};
  info.commandBufferCount = commands != VK_NULL_HANDLE ? 1 : 0;
  info.pCommandBuffers = &commands;
  info.signalSemaphoreCount = 1;
  info.pSignalSemaphores = &semaphore;
  const std::lock_guard lock(device_->queue_mutex());
  PALPA_VK(device_->lost() ? VK_ERROR_DEVICE_LOST : vkQueueSubmit(device_->queue(), 1, &info, VK_NULL_HANDLE));
  return ++last_;
}

void Timeline::wait(std::uint64_t value, double timeout_s) const {
  const VkSemaphore semaphore = semaphore_.get();
  VkSemaphoreWaitInfo info{VK_STRUCTURE_TYPE_SEMAPHORE_WAIT_INFO};
  info.semaphoreCount = 1;
  info.pSemaphores = &semaphore;
  info.pValues = &value;
  // After one wait in vain, there is no need to wait for other work in progress.
  if (device_abandoned && !done(value)) throw failure(device_->description().name + ": does not answer");
  const VkResult result = wait_patiently(*device_, timeout_s, [&](std::uint64_t nanoseconds) {
    return vkWaitSemaphores(device_->get(), &info, nanoseconds);
  });
  check_result(result, "vkWaitSemaphores(...)", __FILE__, __LINE__);
}

bool Timeline::done(std::uint64_t value) const {
  std::uint64_t reached = 0;
  PALPA_VK(vkGetSemaphoreCounterValue(device_->get(), semaphore_.get(), &reached));
  return reached >= value;
}

}  // namespace palpa::gpu
