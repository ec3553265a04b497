// The emulated boards on a pseudo terminal, which programs open as they open a serial port.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <mutex>
#include <span>
#include <string>

#include "base/system/descriptor.hpp"
#include "driver/sonicsurface/emulated/boards.hpp"

namespace palpa::driver::sonicsurface {

class Pty {
 public:
  /// Throws failure() if the system has none left.
  Pty();
  /// The end that programs open, such as /dev/pts/3.
  const std::string& path() const { return path_; }

  /// Passes incoming bytes to the boards at the speed of a serial port until `stop`, which it checks 50 times a second.
  /// `heard` gets the bytes before the boards do, and no bytes at each check without any. `lock` is held while the
  /// boards are used.
  void serve(EmulatedBoards& boards, const std::atomic<bool>& stop, std::mutex& lock,
             const std::function<void(std::span<const std::uint8_t>)>& heard = {}) const;

 private:
  Descriptor master_;
  Descriptor slave_;  ///< stays open, because the last one that closes it takes what was not read yet
  std::string path_;
};

}  // namespace palpa::driver::sonicsurface
