// A USB device as umockdev reads it.
#pragma once

#include <cctype>
#include <string>

namespace palpa::test {

struct FakeDevice {
  std::string ports;  ///< on bus 1: "3", behind a hub "4.2". The hub is another device.
  int address;
  std::string vendor, product;  ///< four hex digits
  std::string serial;
};

/// Low byte first; umockdev requires capitals.
inline std::string swapped(const std::string& hex) {
  std::string bytes = hex.substr(2, 2) + hex.substr(0, 2);
  for (char& c : bytes)
    c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  return bytes;
}

/// One device as umockdev reads it. The descriptors are those of a real FT232H module: one vendor interface with two
/// bulk endpoints of 512 bytes.
inline std::string describe(const FakeDevice& d) {
  const std::string descriptors = "1201000200000040" + swapped(d.vendor) + swapped(d.product) +
                                  "000901020301"
                                  "09022000010100A02D0904000002FFFFFF020705810200020007050202000200";
  std::string path = "/devices/pci0000:00/0000:00:14.0/usb1";
  for (std::size_t end = 0; end != std::string::npos;) {
    end = d.ports.find('.', end == 0 ? 0 : end + 1);
    path += "/1-" + d.ports.substr(0, end);
  }
  const std::string address = (d.address < 10 ? "00" : "0") + std::to_string(d.address);
  return "P: " + path + "\nN: bus/usb/001/" + address + "=" + descriptors + "\nE: DEVNAME=/dev/bus/usb/001/" + address +
         "\nE: DEVTYPE=usb_device\nE: DRIVER=usb\nE: BUSNUM=001\nE: DEVNUM=" + address +
         "\nE: MAJOR=189\nE: MINOR=" + std::to_string(d.address - 1) +
         "\nE: SUBSYSTEM=usb\nA: bConfigurationValue=1\nA: bNumConfigurations=1\nA: busnum=1\nH: descriptors=" +
         descriptors + "\nA: devnum=" + std::to_string(d.address) + "\nA: devpath=" + d.ports +
         "\nA: idProduct=" + d.product + "\nA: idVendor=" + d.vendor +
         (d.serial.empty() ? "" : "\nA: serial=" + d.serial) + "\nA: speed=480\n\n";
}

}  // namespace palpa::test
