// An emulated USB device as the kernel sees it (vhci_port.hpp): descriptors, requests, transfers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace palpa::test {

/// The data that the kernel requests when a device is plugged in.
struct Descriptors {
  std::vector<std::uint8_t> device, configuration;  ///< as on the wire
  std::vector<std::string> strings;                 ///< number 1 first
};

struct ControlRequest {
  std::uint8_t type = 0, request = 0;
  std::uint16_t value = 0, index = 0, length = 0;
  bool to_host() const { return (type & 0x80) != 0; }
};

/// One of the kernel's transfers, until it ends.
struct UsbTransfer {
  std::uint32_t number = 0;
  std::uint8_t endpoint = 0;        ///< with bit 7 set if bytes go to the host
  std::vector<std::uint8_t> bytes;  ///< from the host, or the buffer for bytes to the host
  std::size_t done = 0;             ///< bytes transferred so far
};

/// The result of a transfer or a request.
enum class Answer {
  later,
  done,
  stalled,
  unplugged,  ///< the cable is unplugged now
};

class Gadget {
 public:
  virtual ~Gadget() = default;
  virtual const Descriptors& descriptors() const = 0;
  /// A request of its class or vendor. `bytes` came from the host, or are the buffer for the answer, to be resized to
  /// its length.
  virtual Answer control(double now_s, const ControlRequest& request, std::vector<std::uint8_t>& bytes) = 0;
  /// Continues the oldest transfer of an endpoint.
  virtual Answer carry(double now_s, UsbTransfer& transfer) = 0;
  virtual void advance(double now_s) = 0;
  virtual void halt_cleared(std::uint8_t endpoint) = 0;
  virtual void unplugged(double now_s) = 0;
};

/// A request that all devices know, answered from the descriptors.
Answer standard_request(Gadget& gadget, const ControlRequest& request, std::vector<std::uint8_t>& bytes);

/// A host's requests to a UVC device's controls (UVC 1.5, table A-8).
enum UvcRequest : std::uint8_t {
  set_cur = 0x01,
  get_cur = 0x81,
  get_min,
  get_max,
  get_res,
  get_len,
  get_info,
  get_def
};

/// For descriptors: low byte first.
constexpr std::uint8_t low(unsigned value) {
  return static_cast<std::uint8_t>(value & 0xff);
}
constexpr std::uint8_t high(unsigned value) {
  return static_cast<std::uint8_t>(value >> 8 & 0xff);
}

inline void append(std::vector<std::uint8_t>& to, const std::vector<std::uint8_t>& what) {
  to.insert(to.end(), what.begin(), what.end());
}

}  // namespace palpa::test
