#include "tools/soak/fed_cameras.hpp"

#include <arpa/inet.h>
#include <linux/videodev2.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <random>
#include <sstream>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "driver/cameras/made_up_cameras.hpp"
#include "driver/v4l2/source.hpp"
#include "sensing/synthetic.hpp"

namespace palpa::soak {
namespace {

using driver::v4l2::test::Machine;
using driver::v4l2::test::MadeUpCamera;
using Pictures = std::vector<sensing::FrameSet>;

Pictures render(const session::SourceSetting& setting) {
  const geometry::Mesh finger = session::load_skin(setting.default_skin);
  sensing::SyntheticRig rig(setting.cameras, {}, sensing::Noise::d415, 1);
  Pictures pictures(1 + 2 * depths);
  for (std::size_t n = 0; n < pictures.size(); ++n) {
    std::vector<sensing::Posed> skin;
    const bool many = n > depths;
    for (int finger_of = 0; n > 0 && finger_of < (many ? 20 : 1); ++finger_of) {
      Transform pose(1.0);
      if (many) pose[3] = {0.022 * (finger_of % 5 - 2), 0, 0.022 * (finger_of / 5 - 1.5), 1};
      pose[3][1] = -least_depth_m - step_m * static_cast<double>((n - 1) % depths);
      skin.push_back({&finger, pose});
    }
    rig.render(skin, n, pictures[n]);
  }
  return pictures;
}

/// Emulated cameras in real time. A descriptor is a socket, so that the system's poll() waits for it: each frame is a
/// byte in it, and an unplugged camera closes its other end.
class FedKernel final : public driver::v4l2::Kernel {
 public:
  FedKernel(const session::SourceSetting& setting, int port)
      : pictures_(render(setting)),
        inner_(machine_.kernel()),
        socket_(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)) {
    for (const sensing::Camera& camera : setting.cameras)
      fed_.push_back({.described = camera});
    for (std::size_t c = 0; c < fed_.size(); ++c)
      plug(c);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    if (bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0)
      throw bad_input("fed:" + std::to_string(port), std::strerror(errno));
    const timeval patience{0, 50'000};
    setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof(patience));
    listener_ = std::jthread([this](const std::stop_token& stop) { listen(stop); });
  }
  ~FedKernel() override {
    listener_ = {};
    ::close(socket_);
  }

  /// The nodes' paths, in the rig's order.
  std::vector<std::string> paths() const {
    std::vector<std::string> paths;
    for (const Fed& fed : fed_)
      paths.push_back(fed.path);
    return paths;
  }

  int open(const std::string& path) override {
    const std::lock_guard lock(mutex_);
    const int inner = inner_->open(path);
    if (inner < 0) return inner;
    int ends[2];
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0, ends) != 0) return -errno;
    opened_[ends[0]] = {inner, ends[1], machine_.plugged.at(path)};
    return ends[0];
  }
  void close(int fd) override {
    const std::lock_guard lock(mutex_);
    const Opened opened = opened_.at(fd);
    opened_.erase(fd);
    inner_->close(opened.inner);
    ::close(fd);
    if (opened.other_end >= 0) ::close(opened.other_end);
  }
  int ioctl(int fd, unsigned long request, void* argument) override {
    const std::lock_guard lock(mutex_);
    const int result = inner_->ioctl(opened_.at(fd).inner, request, argument);
    char byte = 0;
    if (request == VIDIOC_DQBUF && result >= 0 && read(fd, &byte, 1) != 1) return -EIO;
    return result;
  }
  const std::byte* map(int fd, std::size_t length, std::size_t offset) override {
    const std::lock_guard lock(mutex_);
    return inner_->map(opened_.at(fd).inner, length, offset);
  }
  void unmap(const std::byte* memory, std::size_t length) override {
    const std::lock_guard lock(mutex_);
    inner_->unmap(memory, length);
  }
  std::vector<driver::v4l2::Node> nodes() override {
    const std::lock_guard lock(mutex_);
    return inner_->nodes();
  }
  std::string resolve(const std::string& path) override { return path; }

 private:
  struct Fed {
    sensing::Camera described;
    std::string path;
    int plugged = 0;                       ///< how many times
    std::shared_ptr<MadeUpCamera> camera;  ///< null while it is unplugged
  };
  struct Opened {
    int inner, other_end;
    std::shared_ptr<MadeUpCamera> camera;
  };

  void plug(std::size_t c) {
    Fed& fed = fed_[c];
    if (fed.camera) return;
    fed.path = "/dev/video" + std::to_string(2 * (c + fed_.size() * static_cast<std::size_t>(fed.plugged++ % 10)));
    fed.camera = machine_.plug(fed.path, "FED" + std::to_string(c));
    fed.camera->offers = {{V4L2_PIX_FMT_Z16, fed.described.width, fed.described.height, fed.described.rate_hz}};
    fed.camera->phase_s = std::numeric_limits<double>::infinity();  // it has no frames of its own
  }
  void pull(std::size_t c) {
    Fed& fed = fed_[c];
    if (!fed.camera) return;
    machine_.unplug(fed.path);
    for (auto& [fd, opened] : opened_) {
      if (opened.camera == fed.camera && opened.other_end >= 0) ::close(std::exchange(opened.other_end, -1));
    }
    fed.camera.reset();
  }
  void deliver(std::size_t c, double time_s, std::size_t picture, const std::string& kind) {
    MadeUpCamera* camera = fed_[c].camera.get();
    if (!camera || !camera->streaming || camera->queued.empty() || picture >= pictures_.size()) return;
    const std::uint32_t buffer = camera->queued.front();
    camera->queued.erase(camera->queued.begin());
    std::vector<std::byte>& memory = camera->buffers[buffer];
    std::memcpy(memory.data(), pictures_[picture].frames[c].depth.data(), memory.size());
    if (kind == "noise") {
      for (std::byte& byte : memory)
        byte = static_cast<std::byte>(random_());
    }
    const std::size_t bytes = kind == "cut" ? memory.size() / 2 : memory.size();
    const std::uint32_t flags = kind == "damaged" ? V4L2_BUF_FLAG_ERROR : 0;
    camera->filled.push_back({buffer, static_cast<std::uint32_t>(bytes), flags, time_s});
    for (auto& [fd, opened] : opened_) {
      if (opened.camera.get() == camera && opened.other_end >= 0) [[maybe_unused]]
        const ssize_t written = write(opened.other_end, "", 1);
    }
  }
  void take(const std::string& line) {
    std::istringstream words(line);
    std::string what, kind;
    std::size_t camera = 0, picture = 0;
    double time_s = 0;
    if (!(words >> what >> camera) || camera >= fed_.size()) return;
    const std::lock_guard lock(mutex_);
    if (what == "pull") pull(camera);
    if (what == "plug") plug(camera);
    if (what == "frame" && words >> time_s >> picture >> kind) deliver(camera, time_s, picture, kind);
  }
  void listen(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
      char text[256];
      if (const ssize_t size = recv(socket_, text, sizeof(text), 0); size > 0)
        take({text, static_cast<std::size_t>(size)});
    }
  }

  std::mutex mutex_;
  const Pictures pictures_;
  Machine machine_;
  std::unique_ptr<Kernel> inner_;
  std::vector<Fed> fed_;
  std::map<int, Opened> opened_;  ///< by descriptor
  std::minstd_rand random_;
  int socket_;
  std::jthread listener_;  ///< ends first
};

}  // namespace

session::SourceKind fed_cameras() {
  return {"fed", "fed:PORT: emulated depth cameras, whose frames another program orders",
          [](const std::string& argument, const session::SourceSetting& setting) {
            auto kernel = std::make_unique<FedKernel>(setting, std::stoi(argument));
            const std::vector<std::string> paths = kernel->paths();
            return driver::v4l2::open_cameras(std::move(kernel), setting.cameras, paths, setting.rig);
          }};
}

}  // namespace palpa::soak
