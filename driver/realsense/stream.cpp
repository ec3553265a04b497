#include "driver/realsense/stream.hpp"

#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <utility>

#include "base/error.hpp"

namespace palpa::driver::realsense {

Stream::Stream(cameras::Host& host, std::unique_ptr<Sensor> sensor, const cameras::Offer& offer)
    : host_(host), sensor_(std::move(sensor)), offer_(offer), fd_(eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {
  if (fd_ < 0) throw failure("no eventfd for a camera's frames: this process has too many files open");
  try {
    sensor_->start(offer_, [this](const Image& image) { arrived(image); });
  } catch (...) {
    close(fd_);
    throw;
  }
}

Stream::~Stream() {
  sensor_->stop();
  for (std::uint32_t slot = 0; slot < most_buffers; ++slot) {
    if (slots_[slot].used) give_back(slot);
  }
  close(fd_);
}

void Stream::give_back(std::uint32_t slot) {
  slots_[slot].used = false;
  sensor_->release(slots_[slot].image);
}

/// Called on the SDK's thread.
void Stream::arrived(const Image& image) {
  const double age_s = image.age_s >= 0 && image.age_s <= oldest_s ? image.age_s : 0;
  const double time_s = host_.now_s() - age_s;
  const std::lock_guard lock(mutex_);
  auto free = std::find_if(slots_.begin(), slots_.end(), [](const Slot& slot) { return !slot.used; });
  if (free == slots_.end() && ready_count_ > 0) {
    free = slots_.begin() + ready_[0];
    give_back(ready_[0]);
    std::copy(ready_.begin() + 1, ready_.begin() + ready_count_--, ready_.begin());
  }
  if (free == slots_.end()) return sensor_->release(image);
  *free = {image, time_s, true};
  ready_[ready_count_++] = static_cast<std::uint32_t>(free - slots_.begin());
  const std::uint64_t one = 1;
  static_cast<void>(!write(fd_, &one, sizeof one));
}

bool Stream::is_whole(const Image& image) const {
  const std::size_t row = std::size_t{offer_.width} * sizeof(std::uint16_t);
  return image.depth && image.width == offer_.width && image.height == offer_.height && image.stride >= row &&
         image.bytes >= std::size_t{image.stride} * (image.height - 1) + row;
}

cameras::Take Stream::take(cameras::Taken& taken) {
  using cameras::Take;
  if (!fault_.empty()) return Take::gone;
  {
    const std::lock_guard lock(mutex_);
    if (ready_count_ > 0) {
      const std::uint32_t slot = ready_[0];
      std::copy(ready_.begin() + 1, ready_.begin() + ready_count_--, ready_.begin());
      taken = {slot, slots_[slot].time_s};
      if (is_whole(slots_[slot].image) && taken.time_s > last_s_) {
        last_s_ = taken.time_s;
        return Take::frame;
      }
      give_back(slot);
      return Take::broken;
    }
    std::uint64_t arrived = 0;
    static_cast<void>(!read(fd_, &arrived, sizeof arrived));
  }
  if (sensor_->connected()) return Take::nothing;
  fault_ = "unplugged";
  return Take::gone;
}

void Stream::copy(const cameras::Taken& taken, std::uint16_t* depth) const {
  const Image image = [&] {
    const std::lock_guard lock(mutex_);
    return slots_[taken.buffer].image;
  }();
  for (std::size_t v = 0; v < image.height; ++v) {
    std::memcpy(depth + v * image.width, image.depth + v * image.stride,
                std::size_t{image.width} * sizeof(std::uint16_t));
  }
}

void Stream::release(const cameras::Taken& taken) {
  const std::lock_guard lock(mutex_);
  give_back(taken.buffer);
}

}  // namespace palpa::driver::realsense
