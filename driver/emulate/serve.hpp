// The code that emulators of one line or one server have in common, from the address to which a loop connects to the
// signal that ends them.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "array/layouts/layout.hpp"
#include "array/transducer_drive.hpp"
#include "driver/emulate/command.hpp"
#include "driver/emulate/violations.hpp"

namespace palpa::driver::emulate {

/// One emulator, ready to listen.
struct Emulator {
  std::string address;  ///< printed, for the program that connects
  const char* wire;     ///< of the trace: "tcp" or "serial"
  const array::Layout& layout;
  double begin_s = 0;  ///< times are counted from here
  std::function<double()> now_s;
  /// The drive that sounds. Called with the lock held.
  std::function<array::Drive()> heard;
  /// The first violations. Called on the thread that takes the bytes, or when no more are taken.
  std::function<std::vector<Violation>()> violations;
  using Took = std::function<void(std::span<const std::uint8_t>)>;
  /// Takes bytes until `stop`. Passes bytes to `took` before the emulated device takes them, and none every 20 ms while
  /// none come. Holds the lock while the device takes them.
  std::function<void(const std::atomic<bool>& stop, std::mutex& lock, const Took& took)> serve;
};

/// Runs with trace and view until a signal sets the caller's Stop, and prints violations as they come. Returns the
/// violations, with times counted from begin_s. Throws failure() if the trace cannot be written.
std::vector<Violation> serve(const Options& options, const Emulator& emulator);

}  // namespace palpa::driver::emulate
