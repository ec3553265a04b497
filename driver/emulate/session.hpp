// What emulators of one line or one server have in common, from the place that a loop connects to, to the signal.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "array/drive.hpp"
#include "array/layout.hpp"
#include "driver/emulate/command.hpp"
#include "driver/emulate/violations.hpp"

namespace palpa::driver::emulate {

/// One emulator, ready to listen.
struct Emulator {
  std::string address;  ///< printed, for whoever is to connect
  const char* wire;     ///< of the trace: "tcp" or "serial"
  const array::Layout& layout;
  double begin_s = 0;  ///< times are told from here
  std::function<double()> now_s;
  /// What sounds; the lock is held.
  std::function<array::Drive()> heard;
  /// The first of them; called where the bytes are taken, or when nothing is any more.
  std::function<std::vector<Violation>()> violations;
  using Took = std::function<void(std::span<const std::uint8_t>)>;
  /// Takes bytes until `stop`, tells each before they are taken, and holds the lock while they are.
  std::function<void(const std::atomic<bool>& stop, std::mutex& lock, const Took& took)> serve;
};

/// Until a signal asks the caller's Stop for the end: with its trace and its view, violations as they come. Returns
/// them, told from begin_s. Throws failure() for a trace that cannot be written.
std::vector<Violation> serve(const Options& options, const Emulator& emulator);

}  // namespace palpa::driver::emulate
