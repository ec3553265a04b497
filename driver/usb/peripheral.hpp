// The far end of the cable: a device made of software, such as an emulator. Each call gives the time at which it
// happens, and the device has no clock of its own, so tests need not wait.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "driver/usb/device.hpp"

namespace palpa::driver::usb {

class Peripheral {
 public:
  virtual ~Peripheral() = default;

  struct Identity {
    std::uint16_t vendor = 0, product = 0, release = 0;
    std::string serial;
  };
  virtual const Identity& identity() const = 0;

  /// A vendor request: `done` and how much of `in` was filled, or `stalled`.
  virtual Outcome control(double now_s, const Setup& setup, std::span<std::uint8_t> in, std::size_t& filled) = 0;
  /// Takes bytes from the front of `bytes`, as many as it has room for; the others are offered again later.
  virtual std::size_t bulk_out(double now_s, std::uint8_t endpoint, std::span<const std::uint8_t> bytes) = 0;
  /// Advances to that time.
  virtual void advance(double now_s) = 0;
  /// The program that had it open has closed it.
  virtual void closed(double now_s) = 0;
  /// Its cable was pulled, in the middle of anything.
  virtual void unplugged(double now_s) = 0;
};

}  // namespace palpa::driver::usb
