// An emulated OpenMPD board: an FT232H and the logic behind it. It is as strict as the board but reports more: what the
// board would accept silently is a violation.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>

#include "array/transducer_drive.hpp"
#include "driver/emulate/violations.hpp"
#include "driver/openmpd/board_file.hpp"
#include "driver/openmpd/emulated/fpga.hpp"
#include "driver/usb/ftdi.hpp"
#include "driver/usb/peripheral.hpp"

namespace palpa::driver::openmpd {

class EmulatedBoard final : public usb::Peripheral {
 public:
  explicit EmulatedBoard(std::string serial, usb::ftdi::Channel channel = usb::ftdi::Channel::fifo);

  const Identity& identity() const override { return identity_; }
  usb::Outcome control(double now_s, const usb::Setup& setup, std::span<std::uint8_t> in, std::size_t& filled) override;
  std::size_t bulk_out(double now_s, std::uint8_t endpoint, std::span<const std::uint8_t> bytes) override;
  void advance(double now_s) override;
  void closed(double now_s) override;
  void unplugged(double now_s) override;

  Fpga& fpga() { return fpga_; }
  const Fpga& fpga() const { return fpga_; }
  const emulate::Violations& violations() const { return violations_; }

 private:
  static constexpr std::size_t chip_bytes = 1024;  ///< the FT232H's own buffer towards the board
  /// What usb::ftdi::ready_requests ask for, in order.
  enum class Step { closed, reset, mode, latency, purged };

  void violate(double now_s, const std::string& what) { violations_.add(now_s, what); }
  void drain(double now_s);

  Identity identity_;
  usb::ftdi::Channel channel_;
  emulate::Violations violations_;
  Fpga fpga_;
  Step step_ = Step::closed;
  std::array<std::uint8_t, chip_bytes> chip_{};
  std::size_t waiting_ = 0;
  std::uint64_t dividers_at_reset_ = 0;
  double closed_s_ = -1;  ///< when it was released; negative: it was not, or it was checked since
};

/// The drive of that board's transducers, in layout order: each pulse's first harmonic relative to a centred one of
/// half a period, with the transducer's own offset. A transducer that is off has phase 0.
array::Drive heard_drive(const Pulses& pulses, const Calibration& calibration, double late_periods = 0);

}  // namespace palpa::driver::openmpd
