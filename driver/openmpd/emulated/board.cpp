#include "driver/openmpd/emulated/board.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <utility>

namespace palpa::driver::openmpd {
namespace {

namespace ftdi = usb::ftdi;
using usb::Outcome;
using usb::Setup;

/// When a full board is released, everything that still waits in it is shown within this time.
constexpr double last_frames_s = 0.05;

/// The place of a pin's transducer: 16 column + row, row 0 at the top. Read off the board, quarter by quarter: each 64
/// pins serve four columns, from the right, and each 8 of them serve two rows, from the bottom.
std::size_t transducer_at(unsigned pin) {
  constexpr unsigned column_within[] = {1, 0, 3, 2, 1, 0, 2, 3};
  constexpr unsigned row_within[] = {0, 0, 0, 0, 1, 1, 1, 1};
  const unsigned column = 12 - 4 * (pin >> 6) + column_within[pin & 7];
  const unsigned row = 14 - 2 * ((pin >> 3) & 7) + row_within[pin & 7];
  return 16 * column + row;
}

}  // namespace

EmulatedBoard::EmulatedBoard(std::string serial, ftdi::Channel channel)
    : identity_{ftdi::vendor, ftdi::product_232h, ftdi::release_232h, std::move(serial)},
      channel_(channel),
      fpga_(violations_) {}

Outcome EmulatedBoard::control(double now_s, const Setup& setup, std::span<std::uint8_t> in, std::size_t& filled) {
  filled = 0;
  advance(now_s);
  if (setup.request_type == 0xc0 && setup.request == ftdi::read_eeprom && in.size() == 2) {
    in[0] = setup.index == 0 ? static_cast<std::uint8_t>(channel_) : 0;
    in[1] = 0;
    filled = 2;
    return Outcome::done;
  }
  const auto follows = [&](Step before, Step after, const char* what) {
    if (step_ != before)
      violate(now_s, fmt::format("{} out of order: the right order is reset, bit mode, latency, purge", what));
    step_ = after;
  };
  if (setup == ftdi::reset_request()) {
    step_ = Step::reset;
    dividers_at_reset_ = fpga_.dividers_set();
  } else if (setup == ftdi::plain_mode_request()) {
    follows(Step::reset, Step::mode, "a bit mode");
  } else if (setup.request_type == 0x40 && setup.request == ftdi::set_latency) {
    if (setup.value < 2 || setup.value > 255) violate(now_s, "a latency outside of 2 to 255 ms");
    follows(Step::mode, Step::latency, "a latency");
  } else if (setup == ftdi::purge_to_device_request()) {
    if (step_ != Step::purged) follows(Step::latency, Step::purged, "a purge");
    waiting_ = 0;
    fpga_.begin_resync(now_s);
  } else if (setup == ftdi::purge_to_host_request()) {
    if (step_ != Step::purged) violate(now_s, "a purge towards the host before the one towards the board");
  } else {
    violate(now_s,
            fmt::format("a request that an FT232H does not know, or a board does not need: type {} request {} value {} "
                        "index {}",
                        setup.request_type, setup.request, setup.value, setup.index));
    return Outcome::stalled;
  }
  return Outcome::done;
}

std::size_t EmulatedBoard::bulk_out(double now_s, std::uint8_t endpoint, std::span<const std::uint8_t> bytes) {
  advance(now_s);
  if (endpoint != ftdi::endpoint_out) {
    violate(now_s, fmt::format("bytes for endpoint {}, which does not exist", endpoint));
    return bytes.size();
  }
  if (step_ != Step::purged) {
    if (!bytes.empty()) violate(now_s, "bytes before the purge: dropped");
    return bytes.size();
  }
  // In serial mode, the bytes leave at a pin that nothing listens to.
  if (channel_ != ftdi::Channel::fifo) return bytes.size();
  std::size_t taken = waiting_ == 0 ? fpga_.take(now_s, bytes) : 0;
  const std::size_t room = std::min(chip_bytes - waiting_, bytes.size() - taken);
  std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(taken), room,
              chip_.begin() + static_cast<std::ptrdiff_t>(waiting_));
  waiting_ += room;
  if (fpga_.dividers_set() > dividers_at_reset_ + 1) {
    violate(now_s, "the divider was set twice since the board was opened");
    dividers_at_reset_ = fpga_.dividers_set() - 1;
  }
  return taken + room;
}

void EmulatedBoard::drain(double now_s) {
  const std::size_t taken = fpga_.take(now_s, std::span(chip_).first(waiting_));
  std::copy(chip_.begin() + static_cast<std::ptrdiff_t>(taken), chip_.begin() + static_cast<std::ptrdiff_t>(waiting_),
            chip_.begin());
  waiting_ -= taken;
}

void EmulatedBoard::advance(double now_s) {
  fpga_.advance(now_s);
  if (waiting_ > 0) drain(now_s);
  if (closed_s_ >= 0 && now_s >= closed_s_ + last_frames_s) {
    closed_s_ = -1;
    if (fpga_.sounds()) violate(now_s, "left sounding by the program that had it open");
  }
}

void EmulatedBoard::closed(double now_s) {
  advance(now_s);
  step_ = Step::closed;
  closed_s_ = now_s;
}

/// The chip runs on the cable's power; the logic behind it has its own.
void EmulatedBoard::unplugged(double now_s) {
  advance(now_s);
  step_ = Step::closed;
  waiting_ = 0;
  fpga_.begin_resync(now_s);
}

array::Drive heard_drive(const Pulses& pulses, const Calibration& calibration, double late_periods) {
  array::Drive drive(transducers);
  for (unsigned pin = 0; pin < pulses.size(); ++pin) {
    const std::size_t transducer = transducer_at(pin);
    std::complex<double> harmonic = 0;
    for (unsigned i = 0; i < pulses[pin].width; ++i) {
      const double middle_of_count = (pulses[pin].phase + i) % 128 + 0.5;
      harmonic += std::polar(1.0, 2 * std::numbers::pi * middle_of_count / 128);
    }
    // Half a period centred on count 32 is full amplitude at phase 0. The transducer adds its own delay.
    harmonic *=
        std::sin(std::numbers::pi / 128) * std::polar(1.0, calibration.degrees[transducer] * std::numbers::pi / 180 +
                                                               (2 * late_periods - 0.5) * std::numbers::pi);
    if (pulses[pin].width == 0) continue;
    drive[transducer] = {static_cast<float>(std::abs(harmonic)), static_cast<float>(std::arg(harmonic))};
  }
  return drive;
}

}  // namespace palpa::driver::openmpd
