#include "viewer/window/swapchain.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <exception>
#include <utility>

#include "base/error.hpp"
#include "gpu/check.hpp"
#include "gpu/patience.hpp"

namespace palpa::viewer {
namespace {

constexpr double patience_s = 10;
constexpr auto patience_ns = static_cast<std::uint64_t>(patience_s * 1e9);

/// UNORM, because the renderer's colours are already as they should appear.
VkSurfaceFormatKHR pick_format(const gpu::Device& device, VkSurfaceKHR surface) {
  VkBool32 presents = VK_FALSE;
  PALPA_VK(vkGetPhysicalDeviceSurfaceSupportKHR(device.physical(), device.queue_family(), surface, &presents));
  std::uint32_t count = 0;
  if (presents) PALPA_VK(vkGetPhysicalDeviceSurfaceFormatsKHR(device.physical(), surface, &count, nullptr));
  std::vector<VkSurfaceFormatKHR> formats(count);
  if (count) PALPA_VK(vkGetPhysicalDeviceSurfaceFormatsKHR(device.physical(), surface, &count, formats.data()));
  for (const VkSurfaceFormatKHR& f : formats) {
    if (f.format == VK_FORMAT_B8G8R8A8_UNORM || f.format == VK_FORMAT_R8G8B8A8_UNORM) return f;
  }
  throw Error(Exit::no_device, fmt::format("{} cannot present to this window: use --headless --screenshot FILE.png, or "
                                           "another device with --gpu",
                                           device.description().name));
}

gpu::Handle<VkSemaphore> make_semaphore(const gpu::Device& device) {
  const VkSemaphoreCreateInfo info{VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO};
  VkSemaphore semaphore = VK_NULL_HANDLE;
  PALPA_VK(vkCreateSemaphore(device.get(), &info, nullptr, &semaphore));
  return {device.get(), semaphore, vkDestroySemaphore};
}

}  // namespace

Presenter::Presenter(const gpu::Device& device, VkSurfaceKHR surface)
    : device_(&device),
      surface_(surface),
      format_(pick_format(device, surface)),
      renderer_(device, format_.format),
      slow_(on_processor()),
      drained_(device, "window drained") {
  for (Flight& flight : flights_) {
    flight.recorder = gpu::Recorder(device, "window frame");
    flight.acquired = make_semaphore(device);
    flight.time = gpu::Timestamps(device, 1);
    VkFenceCreateInfo info{VK_STRUCTURE_TYPE_FENCE_CREATE_INFO};
    info.flags = VK_FENCE_CREATE_SIGNALED_BIT;
    VkFence fence = VK_NULL_HANDLE;
    PALPA_VK(vkCreateFence(device.get(), &info, nullptr, &fence));
    flight.done = gpu::Handle<VkFence>(device.get(), fence, vkDestroyFence);
  }
}

Presenter::~Presenter() {
  if (gpu::device_abandoned) return;
  try {
    drain();
  } catch (const std::exception&) {
    // The device does not answer or is lost, but this cannot be reported from here.
  }
}

// Presentation keeps images and semaphores in use, and the frames' fences do not say until when.
void Presenter::drain() {
  drained_.wait(drained_.submit(), patience_s);
}

void Presenter::finish() {
  wait(std::array{flights_[0].done.get(), flights_[1].done.get()});
}

void Presenter::wait(std::span<const VkFence> fences) {
  PALPA_VK(gpu::wait_patiently(*device_, patience_s, [&](std::uint64_t nanoseconds) {
    return vkWaitForFences(device_->get(), static_cast<std::uint32_t>(fences.size()), fences.data(), VK_TRUE,
                           nanoseconds);
  }));
}

bool Presenter::rebuild(std::uint32_t width, std::uint32_t height) {
  VkSurfaceCapabilitiesKHR surface;
  PALPA_VK(vkGetPhysicalDeviceSurfaceCapabilitiesKHR(device_->physical(), surface_, &surface));
  VkExtent2D extent = surface.currentExtent;
  if (extent.width == 0xffffffffu) {
    extent = {std::clamp(width, surface.minImageExtent.width, surface.maxImageExtent.width),
              std::clamp(height, surface.minImageExtent.height, surface.maxImageExtent.height)};
  }
  if (extent.width == 0 || extent.height == 0) return false;

  finish();
  drain();  // only when the window changes
  images_.clear();
  VkSwapchainCreateInfoKHR info{VK_STRUCTURE_TYPE_SWAPCHAIN_CREATE_INFO_KHR};
  info.surface = surface_;
  info.minImageCount =
      surface.maxImageCount ? std::min(surface.minImageCount + 1, surface.maxImageCount) : surface.minImageCount + 1;
  info.imageFormat = format_.format;
  info.imageColorSpace = format_.colorSpace;
  info.imageExtent = extent;
  info.imageArrayLayers = 1;
  info.imageUsage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT |
                    (surface.supportedUsageFlags & static_cast<VkImageUsageFlags>(VK_IMAGE_USAGE_TRANSFER_DST_BIT));
  info.preTransform = surface.currentTransform;
  info.compositeAlpha = surface.supportedCompositeAlpha & VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR
                            ? VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR
                            : VK_COMPOSITE_ALPHA_INHERIT_BIT_KHR;
  info.presentMode = VK_PRESENT_MODE_FIFO_KHR;  // every device has it, and it draws no frames that nobody sees
  info.clipped = VK_TRUE;
  info.oldSwapchain = swapchain_.get();
  VkSwapchainKHR swapchain = VK_NULL_HANDLE;
  PALPA_VK(vkCreateSwapchainKHR(device_->get(), &info, nullptr, &swapchain));
  swapchain_ = gpu::Handle<VkSwapchainKHR>(device_->get(), swapchain, vkDestroySwapchainKHR);

  std::uint32_t count = 0;
  PALPA_VK(vkGetSwapchainImagesKHR(device_->get(), swapchain, &count, nullptr));
  std::vector<VkImage> images(count);
  PALPA_VK(vkGetSwapchainImagesKHR(device_->get(), swapchain, &count, images.data()));
  for (VkImage image : images) {
    VkImageViewCreateInfo view_info{VK_STRUCTURE_TYPE_IMAGE_VIEW_CREATE_INFO};
    view_info.image = image;
    view_info.viewType = VK_IMAGE_VIEW_TYPE_2D;
    view_info.format = format_.format;
    view_info.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
    VkImageView view = VK_NULL_HANDLE;
    PALPA_VK(vkCreateImageView(device_->get(), &view_info, nullptr, &view));
    images_.push_back({image, {device_->get(), view, vkDestroyImageView}, make_semaphore(*device_)});
  }
  if (extent.width != extent_.width || extent.height != extent_.height) {
    for (Flight& flight : flights_) {
      flight.canvases = {};
      flight.pixels = {};
    }
  }
  extent_ = extent;
  asked_width_ = width;
  asked_height_ = height;
  stale_ = false;
  return true;
}

void Presenter::submit(Flight& flight, VkSemaphore acquired, VkSemaphore drawn) {
  const VkPipelineStageFlags stage = VK_PIPELINE_STAGE_COLOR_ATTACHMENT_OUTPUT_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT;
  const VkCommandBuffer commands = flight.recorder.end();
  VkSubmitInfo info{VK_STRUCTURE_TYPE_SUBMIT_INFO};
  info.waitSemaphoreCount = acquired ? 1 : 0;
  info.pWaitSemaphores = &acquired;
  info.pWaitDstStageMask = &stage;
  info.commandBufferCount = 1;
  info.pCommandBuffers = &commands;
  info.signalSemaphoreCount = drawn ? 1 : 0;
  info.pSignalSemaphores = &drawn;
  const VkFence fence = flight.done.get();
  PALPA_VK(vkResetFences(device_->get(), 1, &fence));
  const std::lock_guard lock(device_->queue_mutex());
  PALPA_VK(device_->lost() ? VK_ERROR_DEVICE_LOST : vkQueueSubmit(device_->queue(), 1, &info, fence));
}

bool Presenter::draw(VkExtent2D window, DrawnPicture& drawn, std::span<const View> views, double ratio,
                     const Sheet* sheet, Fineness fineness, const std::function<void()>& pause) {
  const auto record = [&](VkCommandBuffer commands, Flight& flight, const Image& image, const NextStep& next) {
    const Target target{image.image, image.view.get()};
    if (const std::optional<Fineness> first = std::exchange(expected_, {}))
      renderer_.record(commands, drawn, views, canvas(flight, *first), target, ratio, sheet);
    flight.timed = fineness == Fineness::fine;
    flight.time.begin(commands);
    commands = renderer_.record(commands, drawn, views, canvas(flight, fineness), target, ratio, sheet, next);
    flight.time.mark(commands, "picture");
    gpu::transition(commands, image.image, format_.format, gpu::image_use::colour_target, gpu::image_use::presented);
  };
  return show(window.width, window.height, record, pause);
}

Canvas& Presenter::canvas(Flight& flight, Fineness fineness) {
  std::optional<Canvas>& canvas = flight.canvases[static_cast<std::size_t>(fineness)];
  if (!canvas) canvas = renderer_.make_canvas(extent_, fineness);
  return *canvas;
}

// Looks at the time of the flight's last frame, which is complete.
void Presenter::look_at_time(Flight& flight) {
  if (!std::exchange(flight.timed, false) || on_processor()) return;
  flight.time.read(times_);
  slow_ = !times_.empty() && times_.front().ms > slow_picture_ms;
}

bool Presenter::draw(const drawing::Pixels& pixels) {
  if ((stale_ || pixels.width != asked_width_ || pixels.height != asked_height_) &&
      !rebuild(pixels.width, pixels.height))
    return false;
  if (pixels.width != extent_.width || pixels.height != extent_.height) {
    stale_ = true;
    return false;
  }
  const auto record = [&](VkCommandBuffer commands, Flight& flight, const Image& image, const NextStep&) {
    if (!flight.pixels.data()) flight.pixels = gpu::Upload(*device_, pixels.rgba.size(), "window pixels");
    const auto to = flight.pixels.as<std::uint8_t>();
    const bool blue_first = format_.format == VK_FORMAT_B8G8R8A8_UNORM;
    for (std::size_t i = 0; i < pixels.rgba.size(); i += 4) {
      to[i] = pixels.rgba[blue_first ? i + 2 : i];
      to[i + 1] = pixels.rgba[i + 1];
      to[i + 2] = pixels.rgba[blue_first ? i : i + 2];
      to[i + 3] = 255;
    }
    flight.pixels.record(commands);
    gpu::transition(commands, image.image, format_.format, gpu::image_use::discard_copied, gpu::image_use::copied_to);
    VkBufferImageCopy region{};
    region.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
    region.imageExtent = {pixels.width, pixels.height, 1};
    vkCmdCopyBufferToImage(commands, flight.pixels.ref().buffer, image.image, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1,
                           &region);
    gpu::transition(commands, image.image, format_.format, gpu::image_use::copied_to, gpu::image_use::presented);
  };
  return show(pixels.width, pixels.height, record);
}

bool Presenter::show(std::uint32_t width, std::uint32_t height, const Record& record,
                     const std::function<void()>& pause) {
  if (width == 0 || height == 0) return false;
  if ((stale_ || width != asked_width_ || height != asked_height_) && !rebuild(width, height)) return false;

  Flight& flight = flights_[next_flight_];
  wait(std::array{flight.done.get()});
  look_at_time(flight);
  std::uint32_t index = 0;
  const VkResult acquired = vkAcquireNextImageKHR(device_->get(), swapchain_.get(), patience_ns, flight.acquired.get(),
                                                  VK_NULL_HANDLE, &index);
  if (acquired == VK_ERROR_OUT_OF_DATE_KHR || acquired == VK_TIMEOUT || acquired == VK_NOT_READY) {
    stale_ = true;
    return false;
  }
  // A suboptimal image is still drawn and shown: its semaphore has been taken.
  stale_ = acquired == VK_SUBOPTIMAL_KHR;
  if (!stale_) PALPA_VK(acquired);

  const Image& image = images_[index];
  VkSemaphore unseen = flight.acquired.get();  // the first piece has not waited for it yet
  NextStep next;
  if (pause) {
    next = [&] {
      pause();
      submit(flight, std::exchange(unseen, VK_NULL_HANDLE), VK_NULL_HANDLE);
      wait(std::array{flight.done.get()});
      return flight.recorder.begin();
    };
  }
  record(flight.recorder.begin(), flight, image, next);
  if (pause) pause();
  submit(flight, unseen, image.drawn.get());
  if (pause) {
    wait(std::array{flight.done.get()});
    pause();
  }
  next_flight_ = (next_flight_ + 1) % flights_.size();

  const VkSemaphore drawn = image.drawn.get();
  const VkSwapchainKHR swapchain = swapchain_.get();
  VkPresentInfoKHR present{VK_STRUCTURE_TYPE_PRESENT_INFO_KHR};
  present.waitSemaphoreCount = 1;
  present.pWaitSemaphores = &drawn;
  present.swapchainCount = 1;
  present.pSwapchains = &swapchain;
  present.pImageIndices = &index;
  VkResult presented = VK_SUCCESS;
  {
    const std::lock_guard lock(device_->queue_mutex());
    presented = vkQueuePresentKHR(device_->queue(), &present);
  }
  if (presented == VK_ERROR_OUT_OF_DATE_KHR || presented == VK_SUBOPTIMAL_KHR) {
    stale_ = true;
    return presented == VK_SUBOPTIMAL_KHR;
  }
  PALPA_VK(presented);
  return true;
}

}  // namespace palpa::viewer
