// A serial line: 8N1 at 230400 baud over whatever the kernel has made a tty of (CH340, FTDI, CP210x), without waiting.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "driver/guard/channel.hpp"

namespace palpa::driver::sonicsurface {

class Line {
 public:
  /// Throws failure() for what is not there, is no tty, or is held by another program for a second.
  explicit Line(std::string path);

  const std::string& path() const { return path_; }
  int fd() const { return fd_.get(); }
  bool gone() const { return !fd_; }
  /// Tries to open it again. False: it is still gone.
  bool reopen();

  /// Writes what it takes at once and returns how much that was. Where it is gone: 0, and gone() says so.
  std::size_t write(std::span<const std::uint8_t> bytes);
  /// Forgets what was written and has not left.
  void drop();
  /// Whether all that was written has left the computer, as far as the kernel knows.
  bool drained() const;

 private:
  /// 0, or the errno of what is wrong.
  int open();
  std::string path_;
  Descriptor fd_;
};

}  // namespace palpa::driver::sonicsurface
