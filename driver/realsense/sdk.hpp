// What palpa needs from librealsense2: a few calls, from any thread. If palpa is built with the SDK (CMake's
// PALPA_REALSENSE), librealsense.cpp makes them. Otherwise absent.cpp reports that palpa was built without the SDK. A
// test has its own cameras.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "driver/cameras/device.hpp"
#include "driver/cameras/offers.hpp"

namespace palpa::driver::realsense {

/// The SDK's options that palpa sets, in palpa's units.
enum class Option {
  depth_unit_m,
  exposure_s,
  automatic_exposure,  ///< 0 or 1
  hardware_preset,     ///< the SDK's number
  global_time,         ///< 0 or 1: frames are stamped with the host's time, converted from the camera's clock
};

/// A depth frame in the SDK's memory until it is given back.
struct Image {
  void* frame = nullptr;  ///< for release()
  const std::byte* depth = nullptr;
  std::size_t bytes = 0;
  std::uint32_t width = 0, height = 0, stride = 0;  ///< pixels; stride in bytes
  double age_s = 0;  ///< since it was captured; 0 if its time is on the camera's own clock, which is of no use here
};

/// The depth sensor of one camera. Functions that fail throw failure() with the SDK's words.
class Sensor {
 public:
  virtual ~Sensor() = default;

  /// What it delivers as Z16.
  virtual std::vector<cameras::Offer> offers() = 0;
  /// Throws for a distortion model that palpa does not have.
  virtual cameras::Lens lens(const cameras::Offer& offer) = 0;

  virtual bool has(Option option) = 0;
  virtual double get(Option option) = 0;
  virtual void set(Option option, double value) = 0;

  /// `taker` gets each frame on one of the SDK's threads, and must release() it.
  virtual void start(const cameras::Offer& offer, std::function<void(const Image&)> taker) = 0;
  /// No frame comes after this call.
  virtual void stop() noexcept = 0;
  virtual void release(const Image& image) = 0;
  /// Whether it is still plugged in, as far as the SDK has noticed.
  virtual bool connected() = 0;
};

class Sdk {
 public:
  virtual ~Sdk() = default;
  /// Serial numbers of all cameras with a depth sensor.
  virtual std::vector<std::string> serials() = 0;
  /// Null: it is not plugged in.
  virtual std::unique_ptr<Sensor> find(const std::string& serial) = 0;
};

/// The installed SDK. Throws bad_usage if palpa was built without it.
std::unique_ptr<Sdk> make_sdk();

}  // namespace palpa::driver::realsense
