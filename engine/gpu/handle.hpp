// A move-only owner of one Vulkan object.
#pragma once

#include <volk.h>

#include <atomic>
#include <utility>

namespace palpa::gpu {

/// True once a device did not answer in time (Timeline::wait), or memory ran out. Such a device may work for ever on
/// anything that it was given, and the code that ran out of memory may hold a lock for ever. From then on no object of
/// any device is destroyed, and the program must end with std::_Exit, because the driver's threads do not stop for
/// destructors.
inline std::atomic<bool> device_abandoned{false};

template <typename T>
class Handle {
 public:
  using Destroy = void(VKAPI_PTR*)(VkDevice, T, const VkAllocationCallbacks*);

  Handle() = default;
  Handle(VkDevice device, T object, Destroy destroy) : device_(device), object_(object), destroy_(destroy) {}
  Handle(Handle&& other) noexcept { swap(other); }
  Handle& operator=(Handle&& other) noexcept {
    Handle(std::move(other)).swap(*this);
    return *this;
  }
  ~Handle() {
    if (object_ != VK_NULL_HANDLE && !device_abandoned) destroy_(device_, object_, nullptr);
  }

  T get() const { return object_; }
  explicit operator bool() const { return object_ != VK_NULL_HANDLE; }

 private:
  void swap(Handle& other) {
    std::swap(device_, other.device_);
    std::swap(object_, other.object_);
    std::swap(destroy_, other.destroy_);
  }

  VkDevice device_ = VK_NULL_HANDLE;
  T object_ = VK_NULL_HANDLE;
  Destroy destroy_ = nullptr;
};

}  // namespace palpa::gpu
