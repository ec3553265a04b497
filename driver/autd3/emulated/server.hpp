// An emulated server of AUTD3's Remote protocol, with the devices behind it. It takes what a client sends, and returns
// the answers. Devices keep their state, and their sound, from client to client.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "driver/autd3/emulated/device.hpp"
#include "driver/emulate/violations.hpp"

namespace palpa::driver::autd3 {

class EmulatedServer {
 public:
  struct Pose {
    std::array<float, 3> position_mm;  ///< of transducer 0
    std::array<float, 4> turn;         ///< w, x, y, z
  };

  /// Expects that many devices. `firmware` is the version that they report.
  explicit EmulatedServer(std::size_t devices, std::uint8_t firmware = 0xa5)
      : devices_(devices, EmulatedDevice(firmware)) {}

  /// A client has connected. Anything that an earlier client had begun is forgotten.
  void client_came();
  /// The client is gone. This is a violation without a goodbye, or while devices sound.
  void client_left(double now_s);
  /// Takes what the client sends and adds the answers to `out`. Returns false at the end of the connection.
  bool take(double now_s, std::span<const std::uint8_t> bytes, std::vector<std::uint8_t>& out);

  const std::vector<EmulatedDevice>& devices() const { return devices_; }
  std::vector<EmulatedDevice>& devices() { return devices_; }
  const std::vector<Pose>& poses() const { return poses_; }
  bool silent(double now_s) const;
  bool connected() const { return greeted_; }
  /// The violations of the server and of its devices, oldest first.
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
