// Peripherals on a bus in this process's own memory, with faults to order.
#pragma once

#include <deque>
#include <memory>
#include <vector>

#include "driver/clock.hpp"
#include "driver/usb/device.hpp"
#include "driver/usb/peripheral.hpp"

namespace palpa::driver::usb {

/// What is to go wrong with a device, and what did.
struct Faults {
  bool unplugged = false;
  bool stalled = false;                                     ///< the bulk endpoint, until clear_halt()
  bool takes_nothing = false;                               ///< every bulk packet is put off
  bool refuses_requests = false;                            ///< they are not answered within the patience
  double request_s = 0;                                     ///< that long each request takes
  std::size_t unplug_after = static_cast<std::size_t>(-1);  ///< that many more bulk bytes have come
  /// Transfers end as done when that many bytes of them are sent, or all of them; 0: at their end.
  std::size_t cut_at = 0;
  bool cuts_once = false;
  bool reaped_backwards = false;  ///< of transfers that have ended the one that was begun last is reaped first
  std::size_t bulk_bytes = 0;     ///< that came
};

class InProcessBus final : public Transport {
 public:
  explicit InProcessBus(Clock& clock) : clock_(clock) {}

  /// Plugs it in; it is at bus `bus`, at the next free port, and outlives the transport. The faults are the caller's to
  /// set.
  Faults& plug(Peripheral& peripheral, unsigned bus = 1);

  Listing list(Wanted wanted) override;
  std::unique_ptr<Device> open(const Entry& entry, std::uint8_t endpoint) override;

 private:
  struct Socket {
    Peripheral* peripheral;
    Entry entry;
    Faults faults;
  };
  friend class InProcessDevice;

  Clock& clock_;
  std::deque<Socket> sockets_;
};

}  // namespace palpa::driver::usb
