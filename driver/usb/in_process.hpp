// Peripherals on a bus in this process's own memory, with faults on demand.
#pragma once

#include <deque>
#include <memory>
#include <vector>

#include "driver/clock.hpp"
#include "driver/usb/device.hpp"
#include "driver/usb/peripheral.hpp"

namespace palpa::driver::usb {

/// What should go wrong with a device, and what it got.
struct Faults {
  bool unplugged = false;
  bool stalled = false;                                     ///< the bulk endpoint, until clear_halt()
  bool takes_nothing = false;                               ///< every bulk packet is put off
  bool refuses_requests = false;                            ///< they are not answered within the patience
  double request_s = 0;                                     ///< the time that each request takes
  std::size_t unplug_after = static_cast<std::size_t>(-1);  ///< after this many more bulk bytes
  /// Transfers end as done when this many of their bytes, or all, are sent; 0: at their end.
  std::size_t cut_at = 0;
  bool cuts_once = false;
  bool reaped_backwards = false;  ///< of ended transfers, the one begun last is reaped first
  std::size_t bulk_bytes = 0;     ///< that have come
};

class InProcessBus final : public Transport {
 public:
  explicit InProcessBus(Clock& clock) : clock_(clock) {}

  /// Plugs the peripheral in at bus `bus`, at the next free port. It must outlive the transport. The caller may set the
  /// faults.
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
