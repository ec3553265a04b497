// A USB device made of software as the kernel speaks to it (vhci_port.hpp): descriptors, requests, transfers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace palpa::test {

/// What the kernel asks for when a device is plugged in.
struct Descriptors {
  std::vector<std::uint8_t> device, configuration;  ///< as they go over the wire
  std::vector<std::string> strings;                 ///< number 1 first
};

struct ControlRequest {
  std::uint8_t type = 0, request = 0;
  std::uint16_t value = 0, index = 0, length = 0;
  bool to_host() const { return (type & 0x80) != 0; }
};

/// One of the kernel's transfers, as long as it has not ended.
struct UsbTransfer {
  std::uint32_t number = 0;
  std::uint8_t endpoint = 0;        ///< with bit 7 where bytes go to the host
  std::vector<std::uint8_t> bytes;  ///< from the host, or room for what goes there
  std::size_t done = 0;             ///< of them
};

/// What becomes of a transfer or a request.
enum class Answer {
  later,
  done,
  stalled,
  unplugged,  ///< the cable is pulled, now
};

class Gadget {
 public:
  virtual ~Gadget() = default;
  virtual const Descriptors& descriptors() const = 0;
  /// Of its class or vendor. `bytes` came from the host, or are room for what goes there, to be made as long as that
  /// is.
  virtual Answer control(double now_s, const ControlRequest& request, std::vector<std::uint8_t>& bytes) = 0;
  /// Goes on with the oldest transfer of an endpoint.
  virtual Answer carry(double now_s, UsbTransfer& transfer) = 0;
  virtual void advance(double now_s) = 0;
  virtual void halt_cleared(std::uint8_t endpoint) = 0;
  virtual void unplugged(double now_s) = 0;
};

/// A request that all devices know, answered from the descriptors.
Answer standard_request(Gadget& gadget, const ControlRequest& request, std::vector<std::uint8_t>& bytes);

/// For descriptors: low byte first.
constexpr std::uint8_t low(unsigned value) {
  return static_cast<std::uint8_t>(value & 0xff);
}
constexpr std::uint8_t high(unsigned value) {
  return static_cast<std::uint8_t>(value >> 8 & 0xff);
}

}  // namespace palpa::test
