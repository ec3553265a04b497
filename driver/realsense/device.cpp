#include "driver/realsense/device.hpp"

#include <fmt/format.h>

#include <cmath>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "base/log.hpp"
#include "driver/realsense/stream.hpp"

namespace palpa::driver::realsense {

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

}  // namespace palpa::driver::realsense
