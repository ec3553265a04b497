// The answers of a RealSense D400's extension unit to librealsense's requests: exposure, preset, and the hardware
// monitor. The monitor is a mailbox for commands; it supports the commands for the depth unit and the calibration.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include "usb/gadget.hpp"

namespace palpa::test {

class D400Unit {
 public:
  static constexpr std::uint8_t number = 3;
  D400Unit();

  /// As in the descriptors of the control interface, fed by unit `source`.
  static std::vector<std::uint8_t> descriptor(std::uint8_t source);
  Answer control(const ControlRequest& request, std::vector<std::uint8_t>& bytes);

  // The current settings. Cameras leave the factory with these.
  std::array<std::uint32_t, 5> depth_table{1000, 7, 65535, 0, 5};  ///< the depth unit in micrometres, and others
  std::uint32_t exposure_us() const { return value(3, 4); }
  bool automatic() const { return value(0x0b, 1) != 0; }
  std::uint32_t preset() const { return value(6, 1); }

  /// fx, fy, cx, cy of 848x480 in its calibration.
  std::array<float, 4> lens{640, 640, 423.5, 239.5};
  bool keeps_unit = false;      ///< it takes another depth unit, and does not change it
  bool wrong_checksum = false;  ///< of its calibration
  int busy = 0;                 ///< this many requests are refused before one is accepted

 private:
  std::uint32_t value(std::uint8_t selector, std::size_t size) const;
  void obey();
  void reply(std::uint32_t echo, const std::vector<std::uint8_t>& data);
  std::vector<std::uint8_t> calibration() const;

  std::map<std::uint8_t, std::vector<std::uint8_t>> controls_;  ///< by selector; their lengths differ
};

}  // namespace palpa::test
