// An emulated OpenMPD board on the kernel's USB, and a record of its actions.
#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include "driver/openmpd/emulated/board.hpp"
#include "usb/ft232h_gadget.hpp"
#include "usb/vhci_port.hpp"

namespace palpa::test {

class PluggedBoard {
 public:
  explicit PluggedBoard(const std::string& serial,
                        driver::usb::ftdi::Channel channel = driver::usb::ftdi::Channel::fifo)
      : board_(serial, channel), gadget(board_), port(gadget) {
    board_.fpga().on_shown([this](double, const driver::openmpd::Pulses& pulses) { note(pulses); });
    port.plug();
  }

  /// Pins that sounded alone, in the order in which they first did so.
  std::vector<std::size_t> pins() {
    const auto held = port.hold();
    return pins_;
  }
  bool sounds() {
    const auto held = port.hold();
    return board_.fpga().sounds();
  }
  /// Checks a board that no program has open any more: its final state, and all violations of its rules.
  std::vector<std::string> faults_at_the_end() {
    const auto held = port.hold();
    board_.advance(port.now_s());
    std::vector<std::string> faults;
    if (board_.fpga().sounds()) faults.emplace_back("left sounding");
    for (const auto& violation : board_.violations().kept())
      faults.push_back(violation.what);
    return faults;
  }

 private:
  void note(const driver::openmpd::Pulses& pulses) {
    const auto on = [](const driver::openmpd::Pulse& pulse) { return pulse.width > 0; };
    const auto first = std::find_if(pulses.begin(), pulses.end(), on);
    if (first == pulses.end() || std::find_if(first + 1, pulses.end(), on) != pulses.end()) return;
    const auto pin = static_cast<std::size_t>(first - pulses.begin());
    if (std::find(pins_.begin(), pins_.end(), pin) == pins_.end()) pins_.push_back(pin);
  }

  driver::openmpd::EmulatedBoard board_;
  std::vector<std::size_t> pins_;

 public:
  Ft232hGadget gadget;
  VhciPort port;
};

}  // namespace palpa::test
