#include "driver/usb/libusb.hpp"

#include <fmt/core.h>
#include <libusb.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <memory>
#include <tuple>
#include <utility>

#include "base/error.hpp"

namespace palpa::driver::usb {
namespace {

std::string text_of_error(int code) {
  return libusb_strerror(static_cast<libusb_error>(code));
}

/// A context and the devices that it found.
class Bus {
 public:
  Bus() {
    if (const int result = libusb_init(&context_); result != LIBUSB_SUCCESS) {
      context_ = nullptr;
      problem_ = fmt::format("libusb does not start: {}", text_of_error(result));
      return;
    }
    count_ = libusb_get_device_list(context_, &devices_);
    if (count_ < 0) {
      problem_ = fmt::format("USB devices cannot be listed: {}", text_of_error(static_cast<int>(count_)));
      count_ = 0;
    }
  }
  ~Bus() {
    if (devices_ != nullptr) libusb_free_device_list(devices_, 1);
    if (context_ != nullptr) libusb_exit(context_);
  }
  Bus(const Bus&) = delete;
  Bus& operator=(const Bus&) = delete;

  libusb_context* context() const { return context_; }
  std::span<libusb_device* const> devices() const { return {devices_, static_cast<std::size_t>(count_)}; }
  const std::string& problem() const { return problem_; }

 private:
  libusb_context* context_ = nullptr;
  libusb_device** devices_ = nullptr;
  ssize_t count_ = 0;
  std::string problem_;
};

/// The place as the kernel names it, "1-4.2".
std::string place_of(libusb_device* device) {
  std::array<std::uint8_t, 8> ports{};
  const int depth = libusb_get_port_numbers(device, ports.data(), static_cast<int>(ports.size()));
  if (depth <= 0) return {};
  std::string name = fmt::format("{}-{}", libusb_get_bus_number(device), ports[0]);
  for (int i = 1; i < depth; ++i)
    name += fmt::format(".{}", ports[static_cast<std::size_t>(i)]);
  return name;
}

/// Everyone can read the serial number from the kernel, even if the device may not be opened.
std::string serial_in_sysfs(const std::string& place) {
  std::string serial;
  if (place.empty()) return serial;
  std::ifstream file(std::filesystem::path("/sys/bus/usb/devices") / place / "serial");
  std::getline(file, serial);
  return serial;
}

void look_into(libusb_device* device, const libusb_device_descriptor& descriptor, Entry& out) {
  libusb_device_handle* handle = nullptr;
  out.serial = serial_in_sysfs(out.place);
  const int opened = libusb_open(device, &handle);
  if (opened != LIBUSB_SUCCESS) {
    out.refusal = text_of_error(opened);
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

Outcome outcome_of_error(int code) {
  switch (code) {
    case LIBUSB_ERROR_PIPE:
      return Outcome::stalled;
    case LIBUSB_ERROR_TIMEOUT:
      return Outcome::timed_out;
    case LIBUSB_ERROR_NO_DEVICE:
    case LIBUSB_ERROR_NOT_FOUND:
      return Outcome::gone;
    default:
      return Outcome::failed;
  }
}

Outcome outcome_of(libusb_transfer_status status) {
  switch (status) {
    case LIBUSB_TRANSFER_COMPLETED:
      return Outcome::done;
    case LIBUSB_TRANSFER_STALL:
      return Outcome::stalled;
    case LIBUSB_TRANSFER_CANCELLED:
      return Outcome::cancelled;
    case LIBUSB_TRANSFER_NO_DEVICE:
      return Outcome::gone;
    case LIBUSB_TRANSFER_TIMED_OUT:
      return Outcome::timed_out;
    default:
      return Outcome::failed;
  }
}

class LibusbDevice final : public Device {
 public:
  LibusbDevice(std::unique_ptr<Bus> bus, libusb_device_handle* handle, std::uint8_t endpoint)
      : bus_(std::move(bus)), handle_(handle), endpoint_(endpoint) {
    for (Pending& pending : pending_)
      pending.transfer = libusb_alloc_transfer(0);
    // The device's own descriptor is the one that libusb waits to write to.
    const libusb_pollfd** const all = libusb_get_pollfds(bus_->context());
    for (const libusb_pollfd** one = all; one != nullptr && *one != nullptr; ++one) {
      if (((*one)->events & POLLOUT) != 0) watched_ = {(*one)->fd, (*one)->events, 0};
    }
    libusb_free_pollfds(all);
  }
  ~LibusbDevice() override {
    cancel();
    // Each transfer comes back, even from a device that is gone. Until then, its memory must not be freed.
    for (int i = 0; i < 25 && flying(); ++i)
      handle_events(10000);
    if (flying()) {
      static_cast<void>(bus_.release());
      return;
    }
    for (Pending& pending : pending_)
      libusb_free_transfer(pending.transfer);
    libusb_release_interface(handle_, 0);
    libusb_close(handle_);
  }

  using Device::request;
  Outcome request(const Setup& setup, std::span<std::uint8_t> in, std::size_t& received) override {
    const int result = libusb_control_transfer(handle_, setup.request_type, setup.request, setup.value, setup.index,
                                               in.data(), static_cast<std::uint16_t>(in.size()),
                                               static_cast<unsigned>(1000 * request_patience_s));
    received = result > 0 ? static_cast<std::size_t>(result) : 0;
    return result >= 0 ? Outcome::done : outcome_of_error(result);
  }

  Outcome submit(unsigned number, std::span<const std::uint8_t> bytes) override {
    Pending& pending = pending_[number];
    if (pending.transfer == nullptr) return Outcome::failed;
    // libusb has the same parameter for data that it sends and data that it fills.
    libusb_fill_bulk_transfer(pending.transfer, handle_, endpoint_, const_cast<std::uint8_t*>(bytes.data()),
                              static_cast<int>(bytes.size()), &LibusbDevice::ended, &pending, 0);
    pending.landed = false;
    const int result = libusb_submit_transfer(pending.transfer);
    pending.flies = result == LIBUSB_SUCCESS;
    return pending.flies ? Outcome::done : outcome_of_error(result);
  }

  std::optional<Sent> reap() override {
    handle_events(0);
    for (unsigned number = 0; number < pending_.size(); ++number) {
      Pending& pending = pending_[number];
      if (!pending.flies || !pending.landed) continue;
      pending.flies = false;
      return Sent{number, outcome_of(pending.transfer->status),
                  static_cast<std::size_t>(pending.transfer->actual_length)};
    }
    return std::nullopt;
  }

  pollfd watched() const override { return watched_; }
  bool is_real() const override { return true; }

  void cancel() override {
    for (Pending& pending : pending_) {
      if (pending.flies && !pending.landed) libusb_cancel_transfer(pending.transfer);
    }
  }

  Outcome clear_halt() override {
    const int result = libusb_clear_halt(handle_, endpoint_);
    return result == LIBUSB_SUCCESS ? Outcome::done : outcome_of_error(result);
  }

 private:
  struct Pending {
    libusb_transfer* transfer = nullptr;
    bool flies = false;   ///< begun but not reaped yet
    bool landed = false;  ///< ended
  };

  static void LIBUSB_CALL ended(libusb_transfer* transfer) {
    static_cast<Pending*>(transfer->user_data)->landed = true;
  }
  bool flying() const {
    return std::any_of(pending_.begin(), pending_.end(), [](const Pending& f) { return f.flies && !f.landed; });
  }
  void handle_events(long microseconds) {
    timeval wait{0, microseconds};
    libusb_handle_events_timeout_completed(bus_->context(), &wait, nullptr);
  }

  std::unique_ptr<Bus> bus_;
  libusb_device_handle* handle_;
  std::uint8_t endpoint_;
  pollfd watched_{-1, 0, 0};
  std::array<Pending, most_in_flight> pending_;
};

}  // namespace

Listing LibusbTransport::list(Wanted wanted) {
  Listing listing;
  std::error_code ignored;
  if (!std::filesystem::exists("/dev/bus/usb", ignored)) {
    listing.problem =
        "this machine has no USB (no /dev/bus/usb): in a container, pass it in with --device /dev/bus/usb";
  }
  const Bus bus;
  if (listing.problem.empty()) listing.problem = bus.problem();
  for (libusb_device* device : bus.devices()) {
    libusb_device_descriptor descriptor{};
    if (libusb_get_device_descriptor(device, &descriptor) != LIBUSB_SUCCESS) continue;
    Entry entry;
    entry.vendor = descriptor.idVendor;
    entry.product = descriptor.idProduct;
    entry.release = descriptor.bcdDevice;
    entry.bus = libusb_get_bus_number(device);
    entry.address = libusb_get_device_address(device);
    entry.place = place_of(device);
    if (wanted(entry.vendor, entry.product)) look_into(device, descriptor, entry);
    listing.entries.push_back(std::move(entry));
  }
  if (!listing.entries.empty()) listing.problem.clear();
  std::sort(listing.entries.begin(), listing.entries.end(),
            [](const auto& a, const auto& b) { return std::tie(a.bus, a.address) < std::tie(b.bus, b.address); });
  return listing;
}

std::unique_ptr<Device> LibusbTransport::open(const Entry& entry, std::uint8_t endpoint) {
  auto bus = std::make_unique<Bus>();
  for (libusb_device* device : bus->devices()) {
    if (libusb_get_bus_number(device) != entry.bus || libusb_get_device_address(device) != entry.address) continue;
    libusb_device_handle* handle = nullptr;
    if (const int opened = libusb_open(device, &handle); opened != LIBUSB_SUCCESS) {
      throw failure(fmt::format("USB device {} at {} cannot be opened: {} (palpa doctor says more)", entry.serial,
                                entry.place, text_of_error(opened)));
    }
    libusb_set_auto_detach_kernel_driver(handle, 1);  // if the platform supports it
    if (const int claimed = libusb_claim_interface(handle, 0); claimed != LIBUSB_SUCCESS) {
      libusb_close(handle);
      throw failure(fmt::format("USB device {} at {} cannot be claimed: {}; another program or a kernel driver has it",
                                entry.serial, entry.place, text_of_error(claimed)));
    }
    return std::make_unique<LibusbDevice>(std::move(bus), handle, endpoint);
  }
  throw failure(fmt::format("USB device {} at {} is not plugged in any more", entry.serial, entry.place));
}

}  // namespace palpa::driver::usb
