// A server of AUTD3's Remote protocol made of software, with the devices behind it: what a client sends goes in, what
// it is answered comes out. Devices keep their state, and their sound, from client to client.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "driver/autd3/device.hpp"
#include "driver/emulate/violations.hpp"

namespace palpa::driver::autd3 {

class EmulatedServer {
 public:
  struct Pose {
    std::array<float, 3> position_mm;  ///< of transducer 0
    std::array<float, 4> turn;         ///< w, x, y, z
  };

  /// Waits for as many devices; `firmware` is what they say of themselves.
  explicit EmulatedServer(std::size_t devices, std::uint8_t firmware = 0xa5)
      : devices_(devices, EmulatedDevice(firmware)) {}

  /// A client has come; whatever one before had begun is forgotten.
  void welcome();
  /// It is gone. Without a goodbye, or while devices sound, that is a violation.
  void farewell(double now_s);
  /// Takes what it sends; what it is answered is added to `out`. False: the connection is at its end.
  bool take(double now_s, std::span<const std::uint8_t> bytes, std::vector<std::uint8_t>& out);

  const std::vector<EmulatedDevice>& devices() const { return devices_; }
  std::vector<EmulatedDevice>& devices() { return devices_; }
  const std::vector<Pose>& poses() const { return poses_; }
  bool silent(double now_s) const;
  bool connected() const { return greeted_; }
  /// Its own and its devices', oldest first.
  std::vector<emulate::Violation> violations() const;
  std::size_t violation_count() const;

 private:
  std::size_t needed() const;
  bool answer_request(double now_s, std::vector<std::uint8_t>& out);
  bool refuse(double now_s, const std::string& what, std::vector<std::uint8_t>& out);

  std::vector<EmulatedDevice> devices_;
  std::vector<Pose> poses_;
  std::vector<std::uint8_t> request_;
  bool greeted_ = false, configured_ = false, said_goodbye_ = false;
  emulate::Violations violations_;
};

}  // namespace palpa::driver::autd3
