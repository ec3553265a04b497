// The requests to FTDI's chips that boards need. Each chip is in many kinds of devices, so a device is identified by
// its serial number, never by its ids alone.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "driver/usb/device.hpp"

namespace palpa::driver::usb::ftdi {

inline constexpr std::uint16_t vendor = 0x0403;
inline constexpr std::uint16_t product_232h = 0x6014, release_232h = 0x0900;
inline constexpr std::uint8_t endpoint_out = 0x02, endpoint_in = 0x81;

enum Request : std::uint8_t { reset = 0, set_latency = 9, set_bit_mode = 11, read_eeprom = 0x90 };

constexpr Setup reset_request() {
  return {0x40, reset, 0, 0};
}
/// The chip drops the data that waits for the device behind it, such as a board. (Old programs call this "purge RX".)
constexpr Setup purge_to_device_request() {
  return {0x40, reset, 1, 0};
}
/// The chip drops the data that waits for the host.
constexpr Setup purge_to_host_request() {
  return {0x40, reset, 2, 0};
}
/// The chip returns to the mode that its EEPROM gives.
constexpr Setup plain_mode_request() {
  return {0x40, set_bit_mode, 0, 0};
}
constexpr Setup latency_request(std::uint8_t milliseconds) {
  return {0x40, set_latency, milliseconds, 0};
}

/// The protocol of an FT232H's pins to the device behind it: the low four bits of the first byte of its EEPROM.
enum class Channel : std::uint8_t { uart = 0, fifo = 1, optical = 2, cpu = 4, ft1284 = 8, blank = 15 };
const char* text_of(Channel channel);  ///< "serial (UART)"

/// Reads the protocol of the chip's pins into `channel`.
Outcome read_channel(Device& device, Channel& channel);

/// The requests that make a chip ready, in this order: reset, plain mode, latency of 2 ms (with 1 ms, bytes were seen
/// to be lost), both purges.
inline constexpr std::array<Setup, 5> ready_requests{reset_request(), plain_mode_request(), latency_request(2),
                                                     purge_to_device_request(), purge_to_host_request()};
inline constexpr std::size_t first_purge = 3;  ///< index into these; after trouble, only the purges

}  // namespace palpa::driver::usb::ftdi
