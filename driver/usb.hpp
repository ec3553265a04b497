// The devices on USB, as libusb lists them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace palpa::driver {

struct UsbDevice {
  std::uint16_t vendor = 0, product = 0;
  std::uint8_t bus = 0, address = 0;
  std::string serial;      ///< empty where it has none or may not be read
  std::string refusal;     ///< why it cannot be opened; empty if it can, or if nobody tried
  bool forbidden = false;  ///< the refusal is a matter of permissions
};

struct UsbListing {
  std::vector<UsbDevice> devices;  ///< in the order of bus and address
  std::string problem;             ///< why there is no list; empty if there is one
};

/// Opens the devices for which `wanted` says so, to read their serial numbers, and closes them again; touches no other.
UsbListing list_usb(bool (*wanted)(std::uint16_t vendor, std::uint16_t product));

}  // namespace palpa::driver
