#include "driver/v4l2/kernel.hpp"

#include <fcntl.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <map>
#include <mutex>
#include <system_error>

#include "base/system/kept_from_forks.hpp"

namespace palpa::driver::v4l2 {
namespace {

class Machine final : public Kernel {
 public:
  int open(const std::string& path) override {
    const int fd = ::open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
    if (fd < 0) return -errno;
    const std::lock_guard lock(mutex_);
    kept_.emplace(fd, fd);
    return fd;
  }
  void close(int fd) override {
    const std::lock_guard lock(mutex_);
    kept_.erase(fd);
    ::close(fd);
  }

  int ioctl(int fd, unsigned long request, void* argument) override {
    for (;;) {
      const int result = ::ioctl(fd, request, argument);
      if (result >= 0) return result;
      if (errno != EINTR) return -errno;
    }
  }

  const std::byte* map(int fd, std::size_t length, std::size_t offset) override {
    void* memory = mmap(nullptr, length, PROT_READ, MAP_SHARED, fd, static_cast<off_t>(offset));
    if (memory == MAP_FAILED) return nullptr;
    madvise(memory, length, MADV_DONTFORK);  // it would keep the camera
    return static_cast<const std::byte*>(memory);
  }
  void unmap(const std::byte* memory, std::size_t length) override { munmap(const_cast<std::byte*>(memory), length); }

  std::vector<Node> nodes() override { return find_nodes("/sys"); }
  std::string resolve(const std::string& path) override {
    std::error_code fault;
    const std::filesystem::path real = std::filesystem::canonical(path, fault);
    return fault ? path : real.string();
  }

 private:
  std::mutex mutex_;
  std::map<int, KeptFromForks> kept_;
};

}  // namespace

std::unique_ptr<Kernel> make_kernel() {
  return std::make_unique<Machine>();
}

}  // namespace palpa::driver::v4l2
