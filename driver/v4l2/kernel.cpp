#include "driver/v4l2/kernel.hpp"

#include <fcntl.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <filesystem>
#include <system_error>
#include <utility>

#include "driver/clock.hpp"

namespace palpa::driver::v4l2 {
namespace {

class Machine final : public Kernel {
 public:
  int open(const std::string& path) override {
    const int fd = ::open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
    return fd < 0 ? -errno : fd;
  }
  void close(int fd) override { ::close(fd); }

  int ioctl(int fd, unsigned long request, void* argument) override {
    for (;;) {
      const int result = ::ioctl(fd, request, argument);
      if (result >= 0) return result;
      if (errno != EINTR) return -errno;
    }
  }

  int poll(std::span<pollfd> descriptors, double timeout_s) override {
    const double end_s = now_s() + timeout_s;
    for (;;) {
      const double left_s = std::clamp(end_s - now_s(), 0.0, 60.0);
      const int result = ::poll(descriptors.data(), descriptors.size(), static_cast<int>(std::ceil(left_s * 1e3)));
      if (result >= 0) return result;
      if (errno != EINTR) return -errno;
    }
  }

  const std::byte* map(int fd, std::size_t length, std::size_t offset) override {
    void* memory = mmap(nullptr, length, PROT_READ, MAP_SHARED, fd, static_cast<off_t>(offset));
    return memory == MAP_FAILED ? nullptr : static_cast<const std::byte*>(memory);
  }
  void unmap(const std::byte* memory, std::size_t length) override { munmap(const_cast<std::byte*>(memory), length); }

  std::vector<Node> nodes() override { return find_nodes("/sys"); }
  std::string resolve(const std::string& path) override {
    std::error_code fault;
    const std::filesystem::path real = std::filesystem::canonical(path, fault);
    return fault ? path : real.string();
  }
  std::future<void> beside(std::function<void()> work) override {
    return std::async(std::launch::async, std::move(work));
  }
  double now_s() override { return clock_.now_s(); }

 private:
  SteadyClock clock_;
};

}  // namespace

std::unique_ptr<Kernel> make_kernel() {
  return std::make_unique<Machine>();
}

}  // namespace palpa::driver::v4l2
