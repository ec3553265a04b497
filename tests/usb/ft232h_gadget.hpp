// An FT232H with a peripheral behind it (driver/usb/peripheral.hpp), at a port of the kernel. Tests can inject faults.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "driver/usb/peripheral.hpp"
#include "usb/gadget.hpp"

namespace palpa::test {

class Ft232hGadget final : public Gadget {
 public:
  explicit Ft232hGadget(driver::usb::Peripheral& peripheral);

  const Descriptors& descriptors() const override { return descriptors_; }
  Answer control(double now_s, const ControlRequest& request, std::vector<std::uint8_t>& bytes) override;
  Answer carry(double now_s, UsbTransfer& transfer) override;
  void advance(double now_s) override { peripheral_.advance(now_s); }
  void halt_cleared(std::uint8_t endpoint) override;
  void unplugged(double now_s) override { peripheral_.unplugged(now_s); }

  static constexpr std::size_t never = static_cast<std::size_t>(-1);
  std::atomic<std::size_t> unplug_after{never};  ///< unplug it after this many more bytes
  std::atomic<bool> stalls{false};               ///< it refuses data until the halt is cleared
  std::atomic<bool> takes_nothing{false};
  std::atomic<std::size_t> requests{0};     ///< vendor requests so far
  std::atomic<std::size_t> bytes_taken{0};  ///< so far

 private:
  driver::usb::Peripheral& peripheral_;
  Descriptors descriptors_;
};

}  // namespace palpa::test
