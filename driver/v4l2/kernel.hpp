// What palpa needs from the kernel for cameras: a few system calls, from any thread. A test has its own cameras behind
// it.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "driver/cameras/host.hpp"
#include "driver/v4l2/nodes.hpp"

namespace palpa::driver::v4l2 {

/// What to do if open() returns -EACCES.
inline constexpr const char* no_permission =
    "no permission: add yourself to the group video (usermod -aG video $USER) and log in again";

/// Calls that fail return -errno; none returns -EINTR.
class Kernel : public cameras::Host {
 public:
  /// A descriptor that does not wait.
  virtual int open(const std::string& path) = 0;
  virtual void close(int fd) = 0;
  virtual int ioctl(int fd, unsigned long request, void* argument) = 0;
  /// Null if the memory cannot be mapped.
  virtual const std::byte* map(int fd, std::size_t length, std::size_t offset) = 0;
  virtual void unmap(const std::byte* memory, std::size_t length) = 0;
  /// Every video node of the machine.
  virtual std::vector<Node> nodes() = 0;
  /// The node's own name, for a path that may be a link, such as those in /dev/v4l/by-id.
  virtual std::string resolve(const std::string& path) = 0;
};

/// The machine's kernel.
std::unique_ptr<Kernel> make_kernel();

}  // namespace palpa::driver::v4l2
