// Devices on this machine's USB, by libusb. Every search for devices makes a new context of libusb, so a device that
// comes back is found even without udev.
#pragma once

#include "driver/usb/device.hpp"

namespace palpa::driver::usb {

class LibusbTransport final : public Transport {
 public:
  Listing list(Wanted wanted) override;
  std::unique_ptr<Device> open(const Entry& entry, std::uint8_t endpoint) override;
};

}  // namespace palpa::driver::usb
