#include "driver/umockdev_bus.hpp"

#include <gtest/gtest.h>
#include <linux/usbdevice_fs.h>
#include <sys/ioctl.h>
#include <umockdev.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <span>
#include <utility>

#include "driver/umockdev_device.hpp"

namespace palpa::test {
namespace {

namespace usb = driver::usb;

usbdevfs_urb& urb_of(const UMockdevIoctlData* data) {
  return *reinterpret_cast<usbdevfs_urb*>(data->data);
}

/// The data that the request's argument points to; null if there is none.
UMockdevIoctlData* resolve(UMockdevIoctlData* data, std::size_t offset, std::size_t bytes) {
  GError* error = nullptr;
  UMockdevIoctlData* const found = umockdev_ioctl_data_resolve(data, offset, bytes, &error);
  if (error) g_error_free(error);
  return found;
}

void expect_none(GError* error) {
  if (!error) return;
  ADD_FAILURE() << error->message;
  g_error_free(error);
}

}  // namespace

bool UmockdevBus::works() {
  const char* const loaded = std::getenv("LD_PRELOAD");
  return loaded && std::strstr(loaded, "umockdev");
}

UmockdevBus::UmockdevBus(usb::Peripheral& peripheral, driver::Clock& clock)
    : peripheral_(peripheral), clock_(clock), testbed_(umockdev_testbed_new()), base_(umockdev_ioctl_base_new()) {
  GError* error = nullptr;
  umockdev_testbed_add_from_string(testbed_, describe({"3", 19, "0403", "6014", peripheral.identity().serial}).c_str(),
                                   &error);
  expect_none(std::exchange(error, nullptr));
  g_signal_connect(base_, "handle-ioctl", G_CALLBACK(&UmockdevBus::asked), this);
  umockdev_testbed_attach_ioctl(testbed_, "/dev/bus/usb/001/019", base_, &error);
  expect_none(error);
}

UmockdevBus::~UmockdevBus() {
  GError* error = nullptr;
  umockdev_testbed_detach_ioctl(testbed_, "/dev/bus/usb/001/019", &error);
  expect_none(error);
  g_object_unref(testbed_);
  g_object_unref(base_);
  for (const Transfer& transfer : begun_)
    drop(transfer);
  for (const Transfer& transfer : ended_)
    drop(transfer);
}

void UmockdevBus::drop(const Transfer& transfer) {
  g_object_unref(transfer.bytes);
  g_object_unref(transfer.urb);
}

/// Runs on umockdev's thread, while the caller of libusb waits.
int UmockdevBus::asked(UMockdevIoctlBase*, UMockdevIoctlClient* client, void* self) {
  static_cast<UmockdevBus*>(self)->answer(client);
  return TRUE;
}

void UmockdevBus::answer(UMockdevIoctlClient* client) {
  const unsigned long request = umockdev_ioctl_client_get_request(client);
  UMockdevIoctlData* const argument = umockdev_ioctl_client_get_arg(client);
  int fault = 0;
  switch (request) {
    case USBDEVFS_SUBMITURB:
      fault = unplugged ? ENODEV : submit(argument);
      break;
    case USBDEVFS_DISCARDURB:
      fault = discard(argument);
      break;
    case USBDEVFS_REAPURBNDELAY:
      fault = reap(argument);
      break;
    case USBDEVFS_CLEAR_HALT:
      ++clears;
      stalled = false;
      fault = unplugged ? ENODEV : 0;
      break;
    case USBDEVFS_RELEASEINTERFACE:
      if (unplugged) fault = ENODEV;
      if (!unplugged) peripheral_.closed(clock_.now_s());
      break;
    case USBDEVFS_CLAIMINTERFACE:
    case USBDEVFS_DISCONNECT_CLAIM:
      break;
    case USBDEVFS_GET_CAPABILITIES: {
      const std::uint32_t able = USBDEVFS_CAP_ZERO_PACKET | USBDEVFS_CAP_NO_PACKET_SIZE_LIM;
      std::memcpy(resolve(argument, 0, sizeof able)->data, &able, sizeof able);
      break;
    }
    default:
      fault = ENOTTY;
  }
  umockdev_ioctl_client_complete(client, fault == 0 ? 0 : -1, fault);
}

int UmockdevBus::submit(UMockdevIoctlData* argument) {
  UMockdevIoctlData* const urb = resolve(argument, 0, sizeof(usbdevfs_urb));
  if (!urb) return EFAULT;
  UMockdevIoctlData* const bytes =
      resolve(urb, offsetof(usbdevfs_urb, buffer), static_cast<std::size_t>(urb_of(urb).buffer_length));
  if (!bytes) return EFAULT;
  begun_.push_back(
      {static_cast<UMockdevIoctlData*>(g_object_ref(urb)), static_cast<UMockdevIoctlData*>(g_object_ref(bytes))});
  return 0;
}

/// Its argument is the address of the transfer itself.
int UmockdevBus::discard(const UMockdevIoctlData* argument) {
  gulong address = 0;
  std::memcpy(&address, argument->data, sizeof address);
  const auto found = std::find_if(begun_.begin(), begun_.end(),
                                  [&](const Transfer& transfer) { return transfer.urb->client_addr == address; });
  if (found == begun_.end()) return EINVAL;
  urb_of(found->urb).status = -ENOENT;
  ended_.push_back(*found);
  begun_.erase(found);
  return 0;
}

int UmockdevBus::reap(UMockdevIoctlData* argument) {
  peripheral_.advance(clock_.now_s());
  // A device's endpoint handles one bulk transfer after the other; other requests need not wait.
  bool bulk_waits = false;
  for (auto transfer = begun_.begin(); transfer != begun_.end();) {
    const bool bulk = urb_of(transfer->urb).type == USBDEVFS_URB_TYPE_BULK;
    if ((bulk && bulk_waits) || !has_ended(*transfer)) {
      bulk_waits = bulk_waits || bulk;
      ++transfer;
      continue;
    }
    ended_.push_back(*transfer);
    transfer = begun_.erase(transfer);
  }
  if (ended_.empty()) return unplugged ? ENODEV : EAGAIN;
  const Transfer transfer = ended_.front();
  ended_.pop_front();
  umockdev_ioctl_data_set_ptr(resolve(argument, 0, sizeof(void*)), 0, transfer.urb);
  drop(transfer);
  return 0;
}

bool UmockdevBus::has_ended(Transfer& transfer) {
  usbdevfs_urb& urb = urb_of(transfer.urb);
  if (unplugged) {
    urb.status = -ENODEV;
    return true;
  }
  const std::span bytes(transfer.bytes->data, static_cast<std::size_t>(urb.buffer_length));
  if (urb.type == USBDEVFS_URB_TYPE_CONTROL) {
    usb::Setup setup;
    setup.request_type = bytes[0];
    setup.request = bytes[1];
    std::memcpy(&setup.value, &bytes[2], 2);
    std::memcpy(&setup.index, &bytes[4], 2);
    std::size_t filled = 0;
    const bool done = peripheral_.control(clock_.now_s(), setup, bytes.subspan(8), filled) == usb::Outcome::done;
    resets += setup.request == 0 && setup.value == 0;
    urb.status = done ? 0 : -EPIPE;
    urb.actual_length = static_cast<int>(filled);
    return true;
  }
  if (stalled) {
    urb.status = -EPIPE;
    return true;
  }
  const auto sent = static_cast<std::size_t>(urb.actual_length);
  urb.actual_length += static_cast<int>(peripheral_.bulk_out(clock_.now_s(), urb.endpoint, bytes.subspan(sent)));
  urb.status = 0;
  if (urb.actual_length < urb.buffer_length) return false;
  ++bulk_transfers;
  return true;
}

}  // namespace palpa::test
