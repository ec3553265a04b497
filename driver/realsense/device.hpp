// One RealSense through the SDK: found by its serial number, set up as the rig says, streaming.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "driver/cameras/device.hpp"
#include "driver/cameras/host.hpp"
#include "driver/realsense/sdk.hpp"
#include "sensing/camera.hpp"

namespace palpa::driver::realsense {

class Device final : public cameras::Device {
 public:
  /// `rig` is the file that describes the camera, for messages.
  Device(cameras::Host& host, std::shared_ptr<Sdk> sdk, std::string serial, const sensing::Camera& camera,
         std::string rig);

  const std::string& address() const override { return address_; }
  const std::optional<cameras::Lens>& lens() const override { return lens_; }
  std::unique_ptr<cameras::Stream> open() override;
  std::unique_ptr<cameras::Stream> open_again() override;

 private:
  std::unique_ptr<cameras::Stream> start(std::unique_ptr<Sensor> sensor);
  cameras::Offer choose(Sensor& sensor) const;
  void set_up(Sensor& sensor) const;
  void set(Sensor& sensor, Option option, double value, const char* what, const char* key) const;
  void set_depth_unit(Sensor& sensor);
  void read_lens(Sensor& sensor, const cameras::Offer& offer);

  cameras::Host& host_;
  std::shared_ptr<Sdk> sdk_;
  const std::string serial_, address_;
  const sensing::Camera camera_;
  const std::string rig_;
  std::optional<cameras::Lens> lens_;
  bool trusted_said_ = false;
};

}  // namespace palpa::driver::realsense
