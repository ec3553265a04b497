#include "driver/realsense/source.hpp"

#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <utility>

#include "base/error.hpp"
#include "base/log.hpp"
#include "driver/cameras/device.hpp"
#include "driver/cameras/source.hpp"
#include "driver/realsense/stream.hpp"
#include "sensing/camera.hpp"

namespace palpa::driver::realsense {
namespace {

/// One RealSense through the SDK: found by its serial number, set up as the rig says, streaming.
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

Device::Device(cameras::Host& host, std::shared_ptr<Sdk> sdk, std::string serial, const sensing::Camera& camera,
               std::string rig)
    : host_(host),
      sdk_(std::move(sdk)),
      serial_(std::move(serial)),
      address_("realsense:" + serial_),
      camera_(camera),
      rig_(std::move(rig)) {}

std::unique_ptr<cameras::Stream> Device::open() {
  auto sensor = sdk_->find(serial_);
  if (!sensor) {
    const std::vector<std::string> there = sdk_->serials();
    throw bad_input(address_, there.empty()
                                  ? "is not plugged in, and librealsense2 finds no other camera"
                                  : fmt::format("is not plugged in; librealsense2 finds {}", fmt::join(there, ", ")));
  }
  return start(std::move(sensor));
}

std::unique_ptr<cameras::Stream> Device::open_again() {
  auto sensor = sdk_->find(serial_);
  return sensor ? start(std::move(sensor)) : nullptr;
}

std::unique_ptr<cameras::Stream> Device::start(std::unique_ptr<Sensor> sensor) {
  const cameras::Offer offer = choose(*sensor);
  set_up(*sensor);
  set_depth_unit(*sensor);
  if (camera_.device.own_lens) read_lens(*sensor, offer);
  try {
    return std::make_unique<Stream>(host_, std::move(sensor), offer);
  } catch (const Error& error) {
    throw bad_input(address_, fmt::format("the camera does not start to stream: {}", error.what()));
  }
}

/// Without a rate in the rig, chooses the highest one.
cameras::Offer Device::choose(Sensor& sensor) const {
  const std::vector<cameras::Offer> offers = sensor.offers();
  cameras::Offer best;
  bool sized = false;
  for (const cameras::Offer& offer : offers) {
    if (offer.width != camera_.width || offer.height != camera_.height) continue;
    sized = true;
    const bool wanted = camera_.rate_hz <= 0 || std::abs(offer.rate_hz - camera_.rate_hz) <= 0.02 * camera_.rate_hz;
    if (wanted && offer.rate_hz > best.rate_hz) best = offer;
  }
  if (best.rate_hz > 0) return best;
  if (sized) {
    throw bad_input(address_, fmt::format("does not offer Z16 {}x{} at {:.4g} Hz; it has {}: set rate_hz of {} to one "
                                          "of these, or plug the camera into a USB 3 port",
                                          camera_.width, camera_.height, camera_.rate_hz,
                                          cameras::list_rates(offers, 0, camera_.width, camera_.height), rig_));
  }
  const std::string sizes = cameras::list_sizes(offers, 0);
  throw bad_input(address_,
                  fmt::format("does not offer Z16 of {}x{}; it has {}: set width and height of {} to one of these",
                              camera_.width, camera_.height, sizes.empty() ? "none" : sizes, rig_));
}

void Device::set(Sensor& sensor, Option option, double value, const char* what, const char* key) const {
  if (!sensor.has(option))
    throw bad_input(address_, fmt::format("has no {}, which {} of {} would set", what, key, rig_));
  try {
    sensor.set(option, value);
  } catch (const Error& error) {
    throw bad_input(address_, fmt::format("does not accept {} of {}: {}", key, rig_, error.what()));
  }
}

void Device::set_up(Sensor& sensor) const {
  const sensing::DeviceSetting& setting = camera_.device;
  if (setting.preset) set(sensor, Option::hardware_preset, *setting.preset, "hardware preset", "hardware_preset");
  if (setting.exposure_s) {
    set(sensor, Option::automatic_exposure, *setting.exposure_s == 0, "automatic exposure", "exposure_s");
    if (*setting.exposure_s > 0) set(sensor, Option::exposure_s, *setting.exposure_s, "exposure", "exposure_s");
  }
  try {
    if (sensor.has(Option::global_time)) sensor.set(Option::global_time, 1);
  } catch (const Error&) {
    // The frames' times are then their times of arrival.
  }
}

void Device::set_depth_unit(Sensor& sensor) {
  const double wanted_m = camera_.depth_unit_m;
  const auto is_wanted = [&](double unit_m) { return std::abs(unit_m - wanted_m) <= 1e-3 * wanted_m; };
  if (!sensor.has(Option::depth_unit_m)) {
    if (!std::exchange(trusted_said_, true)) {
      log::warning(fmt::format("{}: does not report its depth unit; palpa assumes {:g} mm, as {} says", address_,
                               wanted_m * 1e3, rig_));
    }
    return;
  }
  if (is_wanted(sensor.get(Option::depth_unit_m))) return;
  std::string why;
  try {
    sensor.set(Option::depth_unit_m, wanted_m);
  } catch (const Error& error) {
    why = fmt::format(" ({})", error.what());
  }
  // With depths ten times too large, the hand would be elsewhere.
  const double unit_m = sensor.get(Option::depth_unit_m);
  if (!is_wanted(unit_m)) {
    throw bad_input(address_, fmt::format("keeps its depth unit of {:g} mm{}; set depth_unit_m = {:g} in {}",
                                          unit_m * 1e3, why, unit_m, rig_));
  }
}

void Device::read_lens(Sensor& sensor, const cameras::Offer& offer) {
  cameras::Lens lens;
  try {
    lens = sensor.lens(offer);
  } catch (const Error& error) {
    throw bad_input(address_, error.what());
  }
  if (lens_ && lens != *lens_) {
    throw failure(fmt::format(
        "{}: its lens has changed: the camera was recalibrated since palpa started; restart palpa", address_));
  }
  lens_ = lens;
}

/// The rig says which camera stands where, so if there are several, each must be named.
std::string find_only(Sdk& sdk) {
  const std::vector<std::string> there = sdk.serials();
  if (there.empty()) {
    throw bad_input("realsense:any", "librealsense2 finds no camera; palpa doctor says what is plugged in");
  }
  if (there.size() > 1) {
    throw bad_usage(fmt::format(
        "source realsense: {} cameras are plugged in; name the rig's cameras, in the rig's order: realsense:{}",
        there.size(), fmt::join(there, ",")));
  }
  return there.front();
}

}  // namespace

std::unique_ptr<sensing::DepthSource> open_cameras(std::unique_ptr<cameras::Host> host, const std::shared_ptr<Sdk>& sdk,
                                                   std::vector<sensing::Camera> cameras, const std::string& argument,
                                                   const std::string& rig) {
  std::vector<std::string> serials = cameras::parse_names(argument, "realsense", "SERIAL or realsense:any");
  cameras::check_count(serials.size(), cameras.size(), "realsense", rig);
  if (serials.size() == 1 && serials[0] == "any") serials[0] = find_only(*sdk);
  std::vector<std::unique_ptr<cameras::Device>> devices;
  for (std::size_t c = 0; c < cameras.size(); ++c)
    devices.push_back(std::make_unique<Device>(*host, sdk, serials[c], cameras[c], rig));
  return cameras::open_cameras(std::move(host), std::move(cameras), std::move(devices), rig);
}

session::SourceKind source_kind() {
  return {"realsense", "realsense:SERIAL[,SERIAL...] or realsense:any: the same cameras through the librealsense2 SDK",
          [](const std::string& argument, const session::SourceSetting& setting) {
            return open_cameras(std::make_unique<cameras::Host>(), make_sdk(), setting.cameras, argument, setting.rig);
          }};
}

}  // namespace palpa::driver::realsense
