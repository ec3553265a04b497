// What palpa asks of librealsense2: a handful of questions, of any thread. librealsense.cpp puts them to the SDK where
// palpa is built with it (CMake's PALPA_REALSENSE), absent.cpp says so where it is not; a test has cameras of its own.
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

/// Those of the SDK's options that palpa sets, in its own units.
enum class Option {
  depth_unit_m,
  exposure_s,
  automatic_exposure,  ///< 0 or 1
  hardware_preset,     ///< the number that the SDK has
  global_time,         ///< 0 or 1: frames are stamped with the host's time, converted from the camera's clock
};

/// A depth frame in the SDK's memory until it is given back.
struct Image {
  void* frame = nullptr;  ///< for release()
  const std::byte* depth = nullptr;
  std::size_t bytes = 0;
  std::uint32_t width = 0, height = 0, stride = 0;  ///< pixels; stride in bytes
  double age_s = 0;  ///< since it was captured; 0 where its time is of the camera's own clock, which says nothing here
};

/// The depth sensor of one camera. What fails throws failure() with the SDK's words.
class Sensor {
 public:
  virtual ~Sensor() = default;

  /// What it gives as Z16.
  virtual std::vector<cameras::Offer> offers() = 0;
  /// Throws for a model of distortion that palpa does not have.
  virtual cameras::Lens lens(const cameras::Offer& offer) = 0;

  virtual bool has(Option option) = 0;
  virtual double get(Option option) = 0;
  virtual void set(Option option, double value) = 0;

  /// `taker` gets each frame on a thread of the SDK's, and has to release() it.
  virtual void start(const cameras::Offer& offer, std::function<void(const Image&)> taker) = 0;
  /// No frame comes after it.
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

/// The installed one. Throws bad_usage where palpa was built without it.
std::unique_ptr<Sdk> make_sdk();

}  // namespace palpa::driver::realsense
