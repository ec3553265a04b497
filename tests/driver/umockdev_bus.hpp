// An emulated device under the real libusb: umockdev intercepts libusb's requests to the kernel's usbfs, and the device
// answers them.
#pragma once

#include <deque>
#include <memory>

#include "driver/clock.hpp"
#include "driver/usb/peripheral.hpp"

using UMockdevTestbed = struct _UMockdevTestbed;
using UMockdevIoctlBase = struct _UMockdevIoctlBase;
using UMockdevIoctlClient = struct _UMockdevIoctlClient;
using UMockdevIoctlData = struct _UMockdevIoctlData;

namespace palpa::test {

class UmockdevBus {
 public:
  /// Plugs it in as an FT232H on port 1-3. The clock is read while the caller waits for libusb.
  UmockdevBus(driver::usb::Peripheral& peripheral, driver::Clock& clock);
  ~UmockdevBus();
  UmockdevBus(const UmockdevBus&) = delete;
  UmockdevBus& operator=(const UmockdevBus&) = delete;

  /// Whether umockdev is loaded before libc; otherwise nothing here works.
  static bool works();

  bool stalled = false;    ///< the bulk endpoint, until its halt is cleared
  bool unplugged = false;  ///< the device no longer exists for the kernel
  unsigned clears = 0, resets = 0, bulk_transfers = 0;

 private:
  struct Transfer {
    UMockdevIoctlData* urb;
    UMockdevIoctlData* bytes;
  };

  static int asked(UMockdevIoctlBase* base, UMockdevIoctlClient* client, void* self);
  void answer(UMockdevIoctlClient* client);
  /// 0, or an errno.
  int submit(UMockdevIoctlData* argument);
  int discard(const UMockdevIoctlData* argument);
  int reap(UMockdevIoctlData* argument);
  bool has_ended(Transfer& transfer);
  static void drop(const Transfer& transfer);

  driver::usb::Peripheral& peripheral_;
  driver::Clock& clock_;
  UMockdevTestbed* testbed_;
  UMockdevIoctlBase* base_;
  std::deque<Transfer> begun_, ended_;
};

}  // namespace palpa::test
