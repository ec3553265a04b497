// A USB device as a driver sees it, whoever carries its bytes: libusb (libusb.hpp), a socket to an emulator
// (local.hpp), or a test's own memory (in_process.hpp). No driver knows which.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace palpa::driver::usb {

/// What became of a transfer or a request.
enum class Outcome {
  done,       ///< all of it, or of a transfer what its `bytes` say
  stalled,    ///< the device refuses it, and a transfer's endpoint until clear_halt()
  timed_out,  ///< a request: no answer within the patience
  cancelled,
  gone,  ///< there is no such device any more
  failed,
};
const char* text_of(Outcome outcome);  ///< "stalled", for messages

/// A vendor request without data, or with data from the device where bit 7 of request_type is set.
struct Setup {
  std::uint8_t request_type = 0x40, request = 0;
  std::uint16_t value = 0, index = 0;
  bool operator==(const Setup&) const = default;
};

/// One that is plugged in.
struct Entry {
  std::uint16_t vendor = 0, product = 0;
  std::uint16_t release = 0;  ///< bcdDevice
  unsigned bus = 0, address = 0;
  std::string place;       ///< BUS-PORT[.PORT...], as the kernel names it: where it is plugged in
  std::string serial;      ///< empty where it has none or may not be read
  std::string refusal;     ///< why it cannot be opened; empty if it can, or if nobody tried
  bool forbidden = false;  ///< the refusal is a matter of permissions
};

struct Listing {
  std::vector<Entry> entries;  ///< in the order of bus and address
  std::string problem;         ///< why there is no list, or not all of it; empty if there is
};

using Wanted = bool (*)(std::uint16_t vendor, std::uint16_t product);

/// A transfer that has ended.
struct Sent {
  unsigned number = 0;
  Outcome outcome = Outcome::done;
  std::size_t bytes = 0;  ///< that the device took, fewer than were given where the outcome is not `done`, and
                          ///< sometimes where it is: what is left is the caller's to send
};

inline constexpr unsigned most_in_flight = 4;       ///< transfers of a device
inline constexpr double request_patience_s = 0.25;  ///< that a request is waited for

/// An open device with one bulk endpoint to write to. Nothing here throws; only request(), clear_halt() and the end
/// wait.
class Device {
 public:
  /// Ends what is in flight, and closes.
  virtual ~Device() = default;

  /// Fills `in` where data comes from the device, and says in `received` how much came.
  virtual Outcome request(const Setup& setup, std::span<std::uint8_t> in, std::size_t& received) = 0;
  Outcome request(const Setup& setup) {
    std::size_t none = 0;
    return request(setup, {}, none);
  }

  /// Begins to send; transfers arrive in the order in which they were begun. `number` is below most_in_flight and not
  /// in flight; `bytes` stay where they are until reap() returns it. Where the outcome is not `done` nothing was begun.
  virtual Outcome submit(unsigned number, std::span<const std::uint8_t> bytes) = 0;
  /// One that has ended, in whatever order; nothing: none has. Never waits.
  virtual std::optional<Sent> reap() = 0;
  /// Ends all that are in flight; each is still to be reaped.
  virtual void cancel() = 0;
  /// After a transfer that stalled.
  virtual Outcome clear_halt() = 0;
};

/// A way to devices.
class Transport {
 public:
  virtual ~Transport() = default;
  /// Looks into the devices for which `wanted` says so, to read their serial numbers; touches no other. Devices that
  /// came or went since the last call are noticed.
  virtual Listing list(Wanted wanted) = 0;
  /// Opens one of list()'s, to write to its bulk endpoint `endpoint`. Throws failure() naming the reason.
  virtual std::unique_ptr<Device> open(const Entry& entry, std::uint8_t endpoint) = 0;
};

}  // namespace palpa::driver::usb
