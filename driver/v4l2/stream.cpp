#include "driver/v4l2/stream.hpp"

#include <fmt/core.h>
#include <linux/videodev2.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <functional>
#include <system_error>

#include "base/error.hpp"
#include "driver/v4l2/offers.hpp"

namespace palpa::driver::v4l2 {
namespace {

constexpr std::uint32_t capture = V4L2_BUF_TYPE_VIDEO_CAPTURE;
constexpr std::uint32_t asked_buffers = 6;  ///< two or three wait to be matched, the camera has the others
constexpr std::uint32_t fewest_buffers = 3;

std::string say(int error) {
  return std::generic_category().message(error);
}

/// Why a node cannot be opened, and what to do about it.
std::string refusal(int error) {
  switch (error) {
    case ENOENT:
    case ENODEV:
    case ENXIO:
      return "there is no such camera; palpa doctor lists what is plugged in";
    case EACCES:
    case EPERM:
      return no_permission;
    case EBUSY:
      return "another program uses this camera; close it first";
    default:
      return fmt::format("cannot be opened: {}", say(error));
  }
}

v4l2_buffer mapped_buffer(std::uint32_t index) {
  v4l2_buffer buffer{};
  buffer.type = capture;
  buffer.memory = V4L2_MEMORY_MMAP;
  buffer.index = index;
  return buffer;
}

}  // namespace

Stream::Stream(Kernel& kernel, const std::string& path, const Wanted& wanted, const std::string& rig,
               const std::function<void(int fd)>& configure)
    : kernel_(kernel), path_(path), fd_(kernel.open(path)) {
  if (fd_ < 0) throw bad_input(path, refusal(-fd_));
  try {
    check_node();
    set_format(wanted, rig);
    set_rate(wanted.rate_hz, rig);
    if (configure) configure(fd_);
    map_buffers();
    start();
  } catch (...) {
    stop();
    throw;
  }
}

Stream::~Stream() {
  stop();
}

void Stream::ask(unsigned long request, void* argument, const char* what) {
  const int result = kernel_.ioctl(fd_, request, argument);
  if (result == -EBUSY) throw bad_input(path_, refusal(EBUSY));
  if (result < 0) throw bad_input(path_, fmt::format("the camera does not {}: {}", what, say(-result)));
}

void Stream::check_node() {
  v4l2_capability capability{};
  if (const int result = kernel_.ioctl(fd_, VIDIOC_QUERYCAP, &capability); result < 0) {
    const bool other = result == -ENOTTY || result == -EINVAL;
    throw bad_input(path_, other ? "is not a video device; palpa doctor lists depth cameras" : refusal(-result));
  }
  const std::uint32_t able =
      capability.capabilities & V4L2_CAP_DEVICE_CAPS ? capability.device_caps : capability.capabilities;
  if (able & V4L2_CAP_META_CAPTURE)
    throw bad_input(path_, "has a camera's metadata, not its images; the camera's stream is the node before it");
  if (!(able & V4L2_CAP_VIDEO_CAPTURE)) throw bad_input(path_, "is not a camera; palpa doctor lists depth cameras");
  if (!(able & V4L2_CAP_STREAMING)) throw bad_input(path_, "is a camera whose driver does not stream into memory");
}

void Stream::set_format(const Wanted& wanted, const std::string& rig) {
  v4l2_format format{};
  format.type = capture;
  format.fmt.pix.pixelformat = V4L2_PIX_FMT_Z16;
  format.fmt.pix.width = wanted.width;
  format.fmt.pix.height = wanted.height;
  format.fmt.pix.field = V4L2_FIELD_NONE;
  const int result = kernel_.ioctl(fd_, VIDIOC_S_FMT, &format);
  // A driver without this format takes another, or returns EINVAL. Anything else is another problem.
  if (result < 0 && result != -EINVAL) {
    const bool known = result == -EBUSY || result == -ENODEV || result == -EACCES || result == -EPERM;
    throw bad_input(path_, known ? refusal(-result) : fmt::format("the camera accepts no format: {}", say(-result)));
  }
  const v4l2_pix_format& given = format.fmt.pix;
  const bool depth = result >= 0 && given.pixelformat == V4L2_PIX_FMT_Z16;
  if (!depth || given.width != wanted.width || given.height != wanted.height) {
    const std::vector<Offer> offers = list_offers(kernel_, fd_);
    const std::string sizes = cameras::list_sizes(offers, V4L2_PIX_FMT_Z16);
    if (sizes.empty()) {
      throw bad_input(
          path_,
          fmt::format(
              "does not give depth, which is the format Z16, but {}; palpa doctor names the camera's other nodes",
              list_formats(offers)));
    }
    throw bad_input(path_,
                    fmt::format("does not offer Z16 of {}x{}; it has {}: set width and height of {} to one of these",
                                wanted.width, wanted.height, sizes, rig));
  }
  width_ = given.width;
  height_ = given.height;
  stride_ = std::max(given.bytesperline, width_ * 2);
}

void Stream::set_rate(double rate_hz, const std::string& rig) {
  v4l2_streamparm parameters{};
  parameters.type = capture;
  v4l2_fract& period = parameters.parm.capture.timeperframe;
  if (rate_hz > 0) {
    period = {1'000'000, static_cast<std::uint32_t>(std::lround(std::min(rate_hz, 1000.0) * 1e6))};
    ask(VIDIOC_S_PARM, &parameters, "accept a frame rate");
  } else {
    ask(VIDIOC_G_PARM, &parameters, "report its frame rate");
  }
  const double given = period.numerator == 0 ? 0 : static_cast<double>(period.denominator) / period.numerator;
  if (!(given > 0)) throw bad_input(path_, fmt::format("does not report its frame rate; set rate_hz of {}", rig));
  if (rate_hz > 0 && std::abs(given - rate_hz) > 0.02 * rate_hz) {
    const std::string rates = cameras::list_rates(list_offers(kernel_, fd_), V4L2_PIX_FMT_Z16, width_, height_);
    throw bad_input(
        path_, fmt::format("does not offer Z16 {}x{} at {:.4g} Hz; it has {}: set rate_hz of {} to one of these, or "
                           "plug the camera into a USB 3 port",
                           width_, height_, rate_hz, rates.empty() ? fmt::format("{:.3g} Hz", given) : rates, rig));
  }
  period_s_ = 1 / given;
}

void Stream::map_buffers() {
  v4l2_requestbuffers request{};
  request.type = capture;
  request.memory = V4L2_MEMORY_MMAP;
  request.count = asked_buffers;
  ask(VIDIOC_REQBUFS, &request, "make buffers");
  if (request.count < fewest_buffers)
    throw bad_input(path_, fmt::format("the camera has {} buffers; palpa needs {}", request.count, fewest_buffers));
  buffer_count_ = std::min(request.count, most_buffers);
  for (std::uint32_t i = 0; i < buffer_count_; ++i) {
    v4l2_buffer buffer = mapped_buffer(i);
    ask(VIDIOC_QUERYBUF, &buffer, "report where its buffers are");
    if (buffer.length < std::size_t{stride_} * height_) {
      throw bad_input(path_, fmt::format("the camera's buffers hold {} bytes, but an image takes {}, {} rows of {}",
                                         buffer.length, std::size_t{stride_} * height_, height_, stride_));
    }
    buffers_[i] = {kernel_.map(fd_, buffer.length, buffer.m.offset), buffer.length};
    if (!buffers_[i].memory) throw failure(path_ + ": the camera's buffers cannot be mapped into memory");
  }
}

void Stream::start() {
  for (std::uint32_t i = 0; i < buffer_count_; ++i) {
    v4l2_buffer buffer = mapped_buffer(i);
    ask(VIDIOC_QBUF, &buffer, "accept its buffers");
  }
  std::uint32_t type = capture;
  const int result = kernel_.ioctl(fd_, VIDIOC_STREAMON, &type);
  if (result == -ENOSPC) {
    throw bad_input(path_,
                    "the USB controller has no room for this stream: plug the cameras into ports of different "
                    "controllers (palpa doctor names them), or set a lower rate_hz");
  }
  if (result < 0) throw bad_input(path_, fmt::format("the camera does not start to stream: {}", say(-result)));
}

void Stream::stop() noexcept {
  if (fd_ < 0) return;
  std::uint32_t type = capture;
  kernel_.ioctl(fd_, VIDIOC_STREAMOFF, &type);
  for (const Mapped& buffer : buffers_) {
    if (buffer.memory) kernel_.unmap(buffer.memory, buffer.length);
  }
  kernel_.close(fd_);
  fd_ = -1;
}

Take Stream::lost(int error) {
  fault_ = error == ENODEV ? "unplugged" : fmt::format("the stream failed ({})", say(error));
  return Take::gone;
}

bool Stream::enqueue(std::uint32_t index) {
  v4l2_buffer buffer = mapped_buffer(index);
  const int result = kernel_.ioctl(fd_, VIDIOC_QBUF, &buffer);
  if (result < 0) lost(-result);
  return result >= 0;
}

Take Stream::take(Taken& taken) {
  if (!fault_.empty()) return Take::gone;
  v4l2_buffer buffer = mapped_buffer(0);
  if (const int result = kernel_.ioctl(fd_, VIDIOC_DQBUF, &buffer); result < 0) {
    if (result == -EAGAIN) return Take::nothing;
    // A device that disappears during a request returns EINVAL once, and ENODEV from then on.
    v4l2_capability capability{};
    const int now = kernel_.ioctl(fd_, VIDIOC_QUERYCAP, &capability);
    return lost(now < 0 ? -now : -result);
  }
  if (buffer.index >= buffer_count_) return lost(EPROTO);
  const double now_s = kernel_.now_s();
  const bool monotonic = (buffer.flags & V4L2_BUF_FLAG_TIMESTAMP_MASK) == V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC;
  const double stamp_s =
      static_cast<double>(buffer.timestamp.tv_sec) + static_cast<double>(buffer.timestamp.tv_usec) * 1e-6;
  taken = {buffer.index, monotonic && stamp_s > 0 && stamp_s < now_s ? stamp_s : now_s};
  const bool whole = !(buffer.flags & V4L2_BUF_FLAG_ERROR) &&
                     buffer.bytesused >= std::size_t{stride_} * (height_ - 1) + std::size_t{width_} * 2;
  if (whole && taken.time_s > last_s_) {
    last_s_ = taken.time_s;
    return Take::frame;
  }
  return enqueue(buffer.index) ? Take::broken : Take::gone;
}

void Stream::copy(const Taken& taken, std::uint16_t* depth) const {
  const std::byte* from = buffers_[taken.buffer].memory;
  const std::size_t row = std::size_t{width_} * sizeof(std::uint16_t);
  if (stride_ == row) {
    std::memcpy(depth, from, row * height_);
    return;
  }
  for (std::uint32_t v = 0; v < height_; ++v)
    std::memcpy(depth + std::size_t{v} * width_, from + std::size_t{v} * stride_, row);
}

void Stream::release(const Taken& taken) {
  if (fault_.empty()) enqueue(taken.buffer);
}

}  // namespace palpa::driver::v4l2
