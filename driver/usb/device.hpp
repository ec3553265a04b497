// A USB device as a driver sees it. Its bytes are carried by libusb (libusb.hpp), by a socket to an emulator
// (local.hpp), or by a test's own memory (in_process.hpp). No driver knows which.
#pragma once

#include <poll.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace palpa::driver::usb {

/// The result of a transfer or a request.
enum class Outcome {
  done,       ///< complete; a transfer has moved as many bytes as its `bytes` says
  stalled,    ///< the device refuses it; a transfer's endpoint refuses all until clear_halt()
  timed_out,  ///< only for a request: no answer within request_patience_s
  cancelled,
  gone,  ///< the device is not there any more
  failed,
};
const char* text_of(Outcome outcome);  ///< "stalled", for messages

/// A vendor request without data, or with data from the device if bit 7 of request_type is set.
struct Setup {
  std::uint8_t request_type = 0x40, request = 0;
  std::uint16_t value = 0, index = 0;
  bool operator==(const Setup&) const = default;
};

/// A device that is plugged in.
struct Entry {
  std::uint16_t vendor = 0, product = 0;
  std::uint16_t release = 0;  ///< bcdDevice
  unsigned bus = 0, address = 0;
  std::string place;       ///< BUS-PORT[.PORT...], as the kernel names it: where it is plugged in
  std::string serial;      ///< empty if it has none or may not be read
  std::string refusal;     ///< why it cannot be opened; empty if it can, or if that was not tried
  bool forbidden = false;  ///< it cannot be opened for lack of permission
};

struct Listing {
  std::vector<Entry> entries;  ///< in the order of bus and address
  std::string problem;         ///< why the list is missing or incomplete; empty if it is complete
};

using Wanted = bool (*)(std::uint16_t vendor, std::uint16_t product);

/// A transfer that has ended.
struct Sent {
  unsigned number = 0;
  Outcome outcome = Outcome::done;
  std::size_t bytes = 0;  ///< how many bytes the device took. If the outcome is not `done`, and sometimes even if it
                          ///< is, these are fewer than were given. The caller must send the rest
};

inline constexpr unsigned most_in_flight = 4;       ///< transfers of a device
inline constexpr double request_patience_s = 0.25;  ///< how long to wait for the answer to a request

/// An open device with one bulk endpoint to write to. Nothing here throws. Only request(), clear_halt() and the
/// destructor wait.
class Device {
 public:
  /// Ends what is in flight, and closes.
  virtual ~Device() = default;

  /// If data comes from the device, fills `in` and sets `received` to the number of bytes.
  virtual Outcome request(const Setup& setup, std::span<std::uint8_t> in, std::size_t& received) = 0;
  Outcome request(const Setup& setup) {
    std::size_t none = 0;
    return request(setup, {}, none);
  }

  /// Begins to send. Transfers arrive in the order in which they were begun. `number` must be below most_in_flight and
  /// not in flight. `bytes` must stay where they are until reap() returns the transfer. If the outcome is not `done`,
  /// nothing was begun.
  virtual Outcome submit(unsigned number, std::span<const std::uint8_t> bytes) = 0;
  /// A transfer that has ended, in any order; nullopt if none has. Never waits.
  virtual std::optional<Sent> reap() = 0;
  /// Ends all transfers in flight. Each must still be reaped.
  virtual void cancel() = 0;
  /// Call after a transfer that stalled.
  virtual Outcome clear_halt() = 0;

  /// The descriptor that is ready when a transfer has ended; its fd is negative if there is none.
  virtual pollfd watched() const { return {-1, 0, 0}; }
  /// Whether bytes take the time that hardware takes for them.
  virtual bool is_real() const { return false; }
};

/// A way to reach devices.
class Transport {
 public:
  virtual ~Transport() = default;
  /// Looks into the devices for which `wanted` is true, to read their serial numbers, and touches no other. Notices
  /// devices that came or went since the last call.
  virtual Listing list(Wanted wanted) = 0;
  /// Opens a device from list(), to write to its bulk endpoint `endpoint`. Throws failure() that names the reason.
  virtual std::unique_ptr<Device> open(const Entry& entry, std::uint8_t endpoint) = 0;
};

}  // namespace palpa::driver::usb
