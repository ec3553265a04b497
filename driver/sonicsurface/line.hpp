// A serial line: 8N1 at 230400 baud over any tty that the kernel provides (CH340, FTDI, CP210x), without waiting.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include "base/system/descriptor.hpp"

namespace palpa::driver::sonicsurface {

class Line {
 public:
  /// Throws failure() if the path does not exist, is not a tty, or is held by another program for a second.
  explicit Line(std::string path);

  const std::string& path() const { return path_; }
  int fd() const { return fd_.get(); }
  bool gone() const { return !fd_; }
  /// Tries to open the line again. Returns false if it is still gone.
  bool reopen();

  /// Writes what the line takes at once, and returns how much that was. If the line is gone, returns 0, and gone() is
  /// true.
  std::size_t write(std::span<const std::uint8_t> bytes);
  /// Discards what was written but has not left.
  void drop();
  /// Whether all that was written has left the computer, as far as the kernel knows.
  bool drained() const;

 private:
  /// Returns 0, or the errno of the fault.
  int open();
  std::string path_;
  Descriptor fd_;
};

}  // namespace palpa::driver::sonicsurface
