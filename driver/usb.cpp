#include "driver/usb.hpp"

#include <fmt/core.h>
#include <libusb.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <memory>
#include <tuple>

namespace palpa::driver {
namespace {

/// The kernel keeps the serial number for everyone to read, also where the device may not be opened.
std::string serial_in_sysfs(libusb_device* device) {
  std::array<std::uint8_t, 8> ports{};
  const int depth = libusb_get_port_numbers(device, ports.data(), static_cast<int>(ports.size()));
  if (depth <= 0) return {};
  std::string name = fmt::format("{}-{}", libusb_get_bus_number(device), ports[0]);
  for (int i = 1; i < depth; ++i)
    name += fmt::format(".{}", ports[static_cast<std::size_t>(i)]);
  std::string serial;
  std::ifstream file(std::filesystem::path("/sys/bus/usb/devices") / name / "serial");
  std::getline(file, serial);
  return serial;
}

void read_serial(libusb_device* device, const libusb_device_descriptor& descriptor, UsbDevice& out) {
  libusb_device_handle* handle = nullptr;
  out.serial = serial_in_sysfs(device);
  const int opened = libusb_open(device, &handle);
  if (opened != LIBUSB_SUCCESS) {
    out.refusal = libusb_strerror(static_cast<libusb_error>(opened));
    out.forbidden = opened == LIBUSB_ERROR_ACCESS;
    return;
  }
  std::array<unsigned char, 256> text{};
  if (out.serial.empty() && descriptor.iSerialNumber != 0) {
    const int length = libusb_get_string_descriptor_ascii(handle, descriptor.iSerialNumber, text.data(),
                                                          static_cast<int>(text.size()));
    if (length > 0) out.serial.assign(text.begin(), text.begin() + length);
  }
  libusb_close(handle);
}

}  // namespace

UsbListing list_usb(bool (*wanted)(std::uint16_t vendor, std::uint16_t product)) {
  UsbListing listing;
  std::error_code ignored;
  if (!std::filesystem::exists("/dev/bus/usb", ignored)) {
    listing.problem =
        "this machine has no USB (no /dev/bus/usb): in a container, pass it in with --device /dev/bus/usb";
  }
  libusb_context* raw_context = nullptr;
  if (const int result = libusb_init(&raw_context); result != LIBUSB_SUCCESS) {
    if (listing.problem.empty()) {
      listing.problem = fmt::format("libusb does not start: {}", libusb_strerror(static_cast<libusb_error>(result)));
    }
    return listing;
  }
  const std::unique_ptr<libusb_context, void (*)(libusb_context*)> context(raw_context, libusb_exit);
  libusb_device** devices = nullptr;
  const ssize_t count = libusb_get_device_list(context.get(), &devices);
  if (count < 0) {
    if (listing.problem.empty()) {
      listing.problem = fmt::format("no list of USB devices: {}", libusb_strerror(static_cast<libusb_error>(count)));
    }
    return listing;
  }
  for (ssize_t i = 0; i < count; ++i) {
    libusb_device_descriptor descriptor{};
    if (libusb_get_device_descriptor(devices[i], &descriptor) != LIBUSB_SUCCESS) continue;
    UsbDevice device;
    device.vendor = descriptor.idVendor;
    device.product = descriptor.idProduct;
    device.bus = libusb_get_bus_number(devices[i]);
    device.address = libusb_get_device_address(devices[i]);
    if (wanted(device.vendor, device.product)) read_serial(devices[i], descriptor, device);
    listing.devices.push_back(std::move(device));
  }
  libusb_free_device_list(devices, 1);
  if (!listing.devices.empty()) listing.problem.clear();
  std::sort(listing.devices.begin(), listing.devices.end(),
            [](const auto& a, const auto& b) { return std::tie(a.bus, a.address) < std::tie(b.bus, b.address); });
  return listing;
}

}  // namespace palpa::driver
