#include "driver/cameras/made_up_cameras.hpp"

#include <linux/usb/video.h>
#include <linux/uvcvideo.h>
#include <linux/videodev2.h>

#include <algorithm>
#include <cerrno>
#include <cmath>

#include "driver/cameras/made_up_frames.hpp"

namespace palpa::driver::v4l2::test {
namespace {

void deliver(MadeUpCamera& camera, double now_s) {
  const double time_s = now_s - camera.late_s;
  const std::uint64_t frame = camera.next++;
  if (camera.frozen || camera.skipped.contains(frame) || camera.queued.empty()) return;
  const std::uint32_t buffer = camera.queued.front();
  camera.queued.erase(camera.queued.begin());
  std::vector<std::byte>& memory = camera.buffers[buffer];
  cameras::test::write_frame(memory.data(), frame, camera.width, camera.height,
                             std::size_t{camera.width} * 2 + camera.padding);
  const bool cut = camera.cut.contains(frame);
  const bool again = camera.repeated.contains(frame);
  camera.filled.push_back({buffer, static_cast<std::uint32_t>(cut ? memory.size() / 2 : memory.size()),
                           camera.damaged.contains(frame) ? V4L2_BUF_FLAG_ERROR : 0u, again ? camera.stamp_s : time_s});
  camera.stamp_s = camera.filled.back().time_s;
}

double due_s(const MadeUpCamera& camera) {
  return camera.phase_s + static_cast<double>(camera.next) / camera.rate_hz + camera.late_s;
}

class MadeUpKernel final : public Kernel {
 public:
  explicit MadeUpKernel(Machine& machine) : machine_(machine) {}

  int open(const std::string& path) override {
    const auto found = machine_.plugged.find(resolve(path));
    if (found == machine_.plugged.end()) return -ENOENT;
    if (found->second->refuses_to_open != 0) return -found->second->refuses_to_open;
    const int fd = 10 + next_fd_++;
    machine_.opened[fd] = *found;
    ++machine_.open_descriptors;
    return fd;
  }
  void close(int fd) override {
    machine_.opened.erase(fd);
    --machine_.open_descriptors;
  }

  int ioctl(int fd, unsigned long request, void* argument) override {
    ++machine_.calls;
    MadeUpCamera& camera = *machine_.opened.at(fd).second;
    if (gone(fd)) return request == VIDIOC_DQBUF && std::exchange(camera.eager_einval, false) ? -EINVAL : -ENODEV;
    switch (request) {
      case VIDIOC_QUERYCAP:
        return query(camera, *static_cast<v4l2_capability*>(argument));
      case VIDIOC_ENUM_FMT:
        return enumerate(camera, *static_cast<v4l2_fmtdesc*>(argument));
      case VIDIOC_ENUM_FRAMESIZES:
        return enumerate(camera, *static_cast<v4l2_frmsizeenum*>(argument));
      case VIDIOC_ENUM_FRAMEINTERVALS:
        return enumerate(camera, *static_cast<v4l2_frmivalenum*>(argument));
      case VIDIOC_S_FMT:
        if (camera.refuses_format != 0) return -camera.refuses_format;
        return set(camera, *static_cast<v4l2_format*>(argument));
      case VIDIOC_S_PARM:
      case VIDIOC_G_PARM:
        return set(camera, *static_cast<v4l2_streamparm*>(argument));
      case VIDIOC_REQBUFS: {
        auto& wanted = *static_cast<v4l2_requestbuffers*>(argument);
        wanted.count = std::min(wanted.count, camera.most_buffers);
        camera.buffers.assign(wanted.count,
                              std::vector<std::byte>((camera.width * 2 + camera.padding) * camera.height));
        return 0;
      }
      case VIDIOC_QUERYBUF: {
        auto& buffer = *static_cast<v4l2_buffer*>(argument);
        buffer.length = static_cast<std::uint32_t>(camera.buffers[buffer.index].size());
        buffer.m.offset = buffer.index;
        return 0;
      }
      case VIDIOC_QBUF:
        return enqueue(camera, *static_cast<v4l2_buffer*>(argument));
      case VIDIOC_DQBUF:
        return dequeue(camera, *static_cast<v4l2_buffer*>(argument));
      case VIDIOC_STREAMON:
        if (camera.refuses_to_start != 0) return -camera.refuses_to_start;
        camera.streaming = true;
        ++camera.starts;
        while (due_s(camera) <= machine_.now_s)
          ++camera.next;
        return 0;
      case VIDIOC_STREAMOFF:
        camera.streaming = false;
        camera.queued.clear();
        camera.filled.clear();
        return 0;
      case UVCIOC_CTRL_QUERY: {
        auto& q = *static_cast<uvc_xu_control_query*>(argument);
        return camera.extension ? camera.extension(q.unit, q.selector, q.query, q.data, q.size) : -ENOENT;
      }
      default:
        return -ENOTTY;
    }
  }

  int poll(std::span<pollfd> descriptors, double timeout_s) override {
    const double end_s = machine_.now_s + timeout_s;
    for (;;) {
      int ready = 0;
      double next_s = end_s;
      for (pollfd& polled : descriptors) {
        const MadeUpCamera& camera = *machine_.opened.at(polled.fd).second;
        polled.revents = gone(polled.fd) ? POLLERR | POLLHUP | POLLPRI : camera.filled.empty() ? 0 : POLLIN;
        ready += polled.revents != 0;
        if (camera.streaming) next_s = std::min(next_s, due_s(camera));
      }
      if (ready > 0 || machine_.now_s >= end_s) return ready;
      machine_.pass(std::max(next_s, machine_.now_s + 1e-5));
    }
  }

  const std::byte* map(int fd, std::size_t length, std::size_t offset) override {
    const auto& buffers = machine_.opened.at(fd).second->buffers;
    if (offset >= buffers.size() || length > buffers[offset].size()) return nullptr;
    ++machine_.mapped;
    return buffers[offset].data();
  }
  void unmap(const std::byte*, std::size_t) override { --machine_.mapped; }

  std::vector<Node> nodes() override {
    std::vector<Node> nodes;
    for (const auto& [path, camera] : machine_.plugged) {
      nodes.push_back(camera->node);
      nodes.back().path = path;
    }
    return nodes;
  }
  std::string resolve(const std::string& path) override {
    const auto link = machine_.links.find(path);
    return link == machine_.links.end() ? path : link->second;
  }
  /// There is no thread: the work is done when its time is over.
  std::future<void> beside(std::function<void()> work) override {
    const auto task = std::make_shared<std::packaged_task<void()>>(std::move(work));
    if (machine_.beside_s == 0)
      (*task)();
    else
      machine_.at(machine_.now_s + machine_.beside_s, [task] { (*task)(); });
    return task->get_future();
  }
  double now_s() override { return machine_.now_s; }

 private:
  bool gone(int fd) const {
    const auto& [path, camera] = machine_.opened.at(fd);
    const auto there = machine_.plugged.find(path);
    return there == machine_.plugged.end() || there->second != camera;
  }

  static int query(const MadeUpCamera& camera, v4l2_capability& able) {
    able.capabilities = V4L2_CAP_DEVICE_CAPS;
    able.device_caps = V4L2_CAP_STREAMING | (camera.metadata ? V4L2_CAP_META_CAPTURE : V4L2_CAP_VIDEO_CAPTURE);
    return 0;
  }

  /// The index-th of the distinct values of `value(offer)` among the offers that `fits` accepts.
  template <typename Value, typename Fits, typename Put>
  static int list(const MadeUpCamera& camera, std::uint32_t index, Value value, Fits fits, Put put) {
    std::vector<decltype(value(Offer{}))> seen;
    for (const Offer& offer : camera.offers) {
      if (!fits(offer) || std::find(seen.begin(), seen.end(), value(offer)) != seen.end()) continue;
      if (seen.size() == index) return put(offer), 0;
      seen.push_back(value(offer));
    }
    return -EINVAL;
  }
  static int enumerate(const MadeUpCamera& camera, v4l2_fmtdesc& out) {
    return list(
        camera, out.index, [](const Offer& o) { return o.format; }, [](const Offer&) { return true; },
        [&](const Offer& o) { out.pixelformat = o.format; });
  }
  static int enumerate(const MadeUpCamera& camera, v4l2_frmsizeenum& out) {
    return list(
        camera, out.index, [](const Offer& o) { return std::pair(o.width, o.height); },
        [&](const Offer& o) { return o.format == out.pixel_format; },
        [&](const Offer& o) {
          out.type = V4L2_FRMSIZE_TYPE_DISCRETE;
          out.discrete = {o.width, o.height};
        });
  }
  static int enumerate(const MadeUpCamera& camera, v4l2_frmivalenum& out) {
    return list(
        camera, out.index, [](const Offer& o) { return o.rate_hz; },
        [&](const Offer& o) { return o.format == out.pixel_format && o.width == out.width && o.height == out.height; },
        [&](const Offer& o) {
          out.type = V4L2_FRMIVAL_TYPE_DISCRETE;
          out.discrete = {1000, static_cast<std::uint32_t>(std::lround(o.rate_hz * 1000))};
        });
  }

  /// Like uvcvideo: an unsupported value becomes the first supported one.
  static int set(MadeUpCamera& camera, v4l2_format& format) {
    v4l2_pix_format& pix = format.fmt.pix;
    const Offer* best = &camera.offers.front();
    for (const Offer& offer : camera.offers) {
      if (offer.format == pix.pixelformat && best->format != pix.pixelformat) best = &offer;
      if (offer.format == pix.pixelformat && offer.width == pix.width && offer.height == pix.height) {
        best = &offer;
        break;
      }
    }
    pix.pixelformat = best->format;
    camera.width = pix.width = best->width;
    camera.height = pix.height = best->height;
    pix.bytesperline = pix.width * 2 + camera.padding;
    pix.sizeimage = pix.bytesperline * pix.height;
    return 0;
  }
  static int set(const MadeUpCamera& camera, v4l2_streamparm& parameters) {
    v4l2_fract& period = parameters.parm.capture.timeperframe;
    const double wanted = period.numerator == 0 ? 1e9 : static_cast<double>(period.denominator) / period.numerator;
    double best = 0;
    for (const Offer& offer : camera.offers) {
      if (offer.width == camera.width && offer.height == camera.height &&
          std::abs(offer.rate_hz - wanted) < std::abs(best - wanted))
        best = offer.rate_hz;
    }
    period = {10'000'000u / 100, static_cast<std::uint32_t>(std::lround(best * 1e5))};
    return 0;
  }

  int enqueue(MadeUpCamera& camera, const v4l2_buffer& buffer) const {
    if (camera.failing)
      camera.filled.push_back({buffer.index, 0, V4L2_BUF_FLAG_ERROR, machine_.now_s});
    else
      camera.queued.push_back(buffer.index);
    return 0;
  }
  static int dequeue(MadeUpCamera& camera, v4l2_buffer& buffer) {
    if (camera.filled.empty()) return -EAGAIN;
    const MadeUpCamera::Filled filled = camera.filled.front();
    camera.filled.erase(camera.filled.begin());
    buffer.index = filled.buffer;
    buffer.bytesused = filled.bytes;
    buffer.flags = filled.flags | (camera.monotonic ? V4L2_BUF_FLAG_TIMESTAMP_MONOTONIC : 0u);
    const double whole_s = std::floor(filled.time_s);
    buffer.timestamp.tv_sec = static_cast<decltype(buffer.timestamp.tv_sec)>(whole_s);
    buffer.timestamp.tv_usec = static_cast<decltype(buffer.timestamp.tv_usec)>((filled.time_s - whole_s) * 1e6);
    return 0;
  }

  Machine& machine_;
  int next_fd_ = 0;
};

}  // namespace

std::shared_ptr<MadeUpCamera> Machine::plug(const std::string& path, const std::string& serial) {
  auto camera = std::make_shared<MadeUpCamera>();
  camera->queued.reserve(16);  // so that tests that count allocations count none of these
  camera->filled.reserve(16);
  const std::string port = "2-" + std::to_string(plugged.size() + 1);
  camera->node = {.path = path,
                  .name = "made up",
                  .interface = port + ":1.1",
                  .place = port,
                  .controller = "0000:00:14.0",
                  .bus = "usb2",
                  .serial = serial,
                  .vendor = 0x1d6b,
                  .product = 0x0ad3,
                  .mbit_s = 5000};
  for (const double rate : {90.0, 60.0, 30.0, 6.0})
    camera->offers.push_back({V4L2_PIX_FMT_Z16, 64, 48, rate});
  camera->offers.push_back({V4L2_PIX_FMT_Z16, 128, 72, 30});
  plug(path, camera);
  return camera;
}

void Machine::plug(const std::string& path, std::shared_ptr<MadeUpCamera> camera) {
  plugged[path] = std::move(camera);
}

void Machine::pass(double until_s) {
  for (;;) {
    double next_s = until_s;
    MadeUpCamera* who = nullptr;
    for (const auto& [path, camera] : plugged) {
      if (camera->streaming && due_s(*camera) <= next_s) {
        next_s = due_s(*camera);
        who = camera.get();
      }
    }
    const bool event = !later.empty() && later.front().first <= next_s;
    if (event) next_s = later.front().first;
    now_s = std::max(now_s, next_s);
    if (event) {
      const auto what = std::move(later.front().second);
      later.erase(later.begin());
      what();
    } else if (who) {
      deliver(*who, next_s);
    } else {
      return;
    }
  }
}

std::unique_ptr<Kernel> Machine::kernel() {
  return std::make_unique<MadeUpKernel>(*this);
}

}  // namespace palpa::driver::v4l2::test
